"""Sensors for measurement: contacts of feet and legs, and the centre of mass."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from models import Robot

CONTACT_FIELDS = 10  # found 1, force 3, position 3, relative velocity 3
SELF_CONTACT = "self_contact"  # sensor of any contact of the robot with itself
_DATA = mujoco.mjtConDataField
_FOUND, _FORCE = 1 << int(_DATA.mjCONDATA_FOUND), 1 << int(_DATA.mjCONDATA_FORCE)
_PLACE, _SPEED = 1 << int(_DATA.mjCONDATA_POS), 1 << int(_DATA.mjCONDATA_LINVEL)
_MANY = 4  # contacts of a foot, of which the engine tells
_SLOTS = {mujoco.mjtGeom.mjGEOM_SPHERE: 1, mujoco.mjtGeom.mjGEOM_CAPSULE: 2}


def ensure_sensors(
    spec: mujoco.MjSpec, robot: Robot, floor: str, uneven: bool = False
) -> None:
    """Add missing sensors, and replace those of the same names that differ.

    An uneven floor has bumps, which any foot touches at several points.
    """
    slots = {} if uneven else _SLOTS
    for geom in robot.card.feet:
        most = slots.get(spec.geom(geom).type, _MANY)
        _ensure(
            spec,
            name=contact_sensor(geom),
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=floor,
            reftype=mujoco.mjtObj.mjOBJ_GEOM,
            refname=geom,
            intprm=[_FOUND | _FORCE | _PLACE | _SPEED, 0, most],
        )
    _ensure(
        spec,
        name="center_of_mass",
        type=mujoco.mjtSensor.mjSENS_SUBTREECOM,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        objname=robot.root,
    )
    _ensure(
        spec,
        name=SELF_CONTACT,
        type=mujoco.mjtSensor.mjSENS_CONTACT,
        objtype=mujoco.mjtObj.mjOBJ_XBODY,
        objname=robot.root,
        reftype=mujoco.mjtObj.mjOBJ_XBODY,
        refname=robot.root,
        intprm=[_FOUND, 0, 1],
    )


def contact_sensor(geom: str) -> str:
    """Name of the contact sensor of a foot geom."""
    return f"contact_{geom}"


def _ensure(spec: mujoco.MjSpec, name: str, **wanted: Any) -> None:
    found = spec.sensor(name)
    if found is not None:
        if all(np.array_equal(getattr(found, key), v) for key, v in wanted.items()):
            return
        spec.delete(found)
    spec.add_sensor(name=name, **wanted)
