"""What measurement reads: contacts of every foot geom, and the centre of mass."""

from __future__ import annotations

import mujoco

from models.robot import Robot

CONTACT_FIELDS = 10  # found 1, force 3, position 3, relative velocity 3
_SLOTS = {mujoco.mjtGeom.mjGEOM_SPHERE: 1, mujoco.mjtGeom.mjGEOM_CAPSULE: 2}


def ensure_sensors(spec: mujoco.MjSpec, robot: Robot, floor: str) -> None:
    """Add what is missing.

    Args:
        spec: World with the robot in it.
        robot: Whose feet.
        floor: Name of the geom that they are to touch.
    """
    present = {sensor.name for sensor in spec.sensors}
    for geom in (name for leg in robot.card.legs.values() for name in leg.foot):
        if contact_sensor(geom) not in present:
            _add_contact_sensor(spec, geom, floor)
    if "center_of_mass" not in present:
        spec.add_sensor(
            name="center_of_mass",
            type=mujoco.mjtSensor.mjSENS_SUBTREECOM,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            objname=robot.root,
        )


def contact_sensor(geom: str) -> str:
    """Name of the contact sensor of a foot geom."""
    return f"contact_{geom}"


def _add_contact_sensor(spec: mujoco.MjSpec, geom: str, floor: str) -> None:
    data = mujoco.mjtConDataField
    fields = (data.mjCONDATA_FOUND, data.mjCONDATA_FORCE, data.mjCONDATA_POS)
    spec.add_sensor(
        name=contact_sensor(geom),
        type=mujoco.mjtSensor.mjSENS_CONTACT,
        objtype=mujoco.mjtObj.mjOBJ_GEOM,
        objname=floor,
        reftype=mujoco.mjtObj.mjOBJ_GEOM,
        refname=geom,
        intprm=[
            sum(1 << int(field) for field in (*fields, data.mjCONDATA_LINVEL)),
            0,
            _SLOTS.get(spec.geom(geom).type, 4),
        ],
    )
