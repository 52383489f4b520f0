"""Sensors of the centre of mass and of contacts; obstacles, which are solid geoms."""

import re
from collections.abc import Sequence
from math import cos, sin
from typing import Any

import mujoco
import numpy as np

from models import Robot
from planner import Array
from sim.scenarios.obstacles import Box, Obstacle, Piece
from sim.world.parts import fixed_geoms

CONTACT_FIELDS = 10  # found 1, force 3, position 3, relative velocity 3
SELF_CONTACT = "self_contact"  # sensor of any contact of the robot with itself
_DATA = mujoco.mjtConDataField
_FOUND, _FORCE = 1 << int(_DATA.mjCONDATA_FOUND), 1 << int(_DATA.mjCONDATA_FORCE)
_PLACE, _SPEED = 1 << int(_DATA.mjCONDATA_POS), 1 << int(_DATA.mjCONDATA_LINVEL)
_GEOM, _SUBTREE = mujoco.mjtObj.mjOBJ_GEOM, mujoco.mjtObj.mjOBJ_XBODY
_MANY = 4  # contacts of a foot, of which the engine tells
_PLAIN = {"cutoff": 0.0, "delay": 0.0, "interval": (0.0, 0.0), "nsample": 0}
_SLOTS = {mujoco.mjtGeom.mjGEOM_SPHERE: 1, mujoco.mjtGeom.mjGEOM_CAPSULE: 2}

Part = tuple[mujoco.mjtObj, str]  # kind and name of what touches or is touched
Data = tuple[int, int]  # fields of a contact, and of how many


def ensure_sensors(
    spec: mujoco.MjSpec, robot: Robot, floor: str, uneven: bool = False
) -> None:
    """Add missing sensors, and replace those of the same names that differ.

    All are read at every step as they are. An uneven floor has bumps, which any foot
    touches at several points.
    """
    spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_SENSOR)
    slots = {} if uneven else _SLOTS
    for geom in robot.card.feet:
        data = _FOUND | _FORCE | _PLACE | _SPEED, slots.get(spec.geom(geom).type, _MANY)
        _watch(spec, contact_sensor(geom), (_GEOM, floor), (_GEOM, geom), data)
    body = {"objtype": mujoco.mjtObj.mjOBJ_BODY, "objname": robot.root}
    _ensure(spec, "center_of_mass", type=mujoco.mjtSensor.mjSENS_SUBTREECOM, **body)
    _watch(spec, SELF_CONTACT, (_SUBTREE, robot.root), (_SUBTREE, robot.root))


def contact_sensor(geom: str) -> str:
    """Name of the contact sensor of a foot geom."""
    return f"contact_{geom}"


def floor_in(model: mujoco.MjModel, foot: str) -> int:
    """The geom of a world that the contact sensor of a foot geom watches."""
    return int(model.sensor_objid[model.sensor(contact_sensor(foot)).id])


def _watch(
    spec: mujoco.MjSpec, name: str, one: Part, other: Part, data: Data = (_FOUND, 1)
) -> None:
    """Ensure a sensor of the contacts between two parts."""
    kind = {"type": mujoco.mjtSensor.mjSENS_CONTACT, "intprm": [data[0], 0, data[1]]}
    first = {"objtype": one[0], "objname": one[1]}
    _ensure(spec, name, **kind, **first, reftype=other[0], refname=other[1])


def _ensure(spec: mujoco.MjSpec, name: str, **wanted: Any) -> None:
    found, wanted = spec.sensor(name), {**_PLAIN, **wanted}
    if found is not None:
        if all(np.array_equal(getattr(found, key), v) for key, v in wanted.items()):
            return
        spec.delete(found)
    spec.add_sensor(name=name, **wanted)


WALL = r"obstacle_(\d+)_\d+"  # name of a piece, both from 1
COLOUR = (0.45, 0.48, 0.53, 1.0)
EVERYTHING = 2**31 - 1  # all contact types
SUNK = 0.01  # [m] below the floor, so that no gap is visible


def add_walls(
    spec: mujoco.MjSpec, robot: Robot, floor: str, obstacles: Sequence[Obstacle]
) -> None:
    """Replace the obstacles of a world, with a contact sensor for every piece.

    Both are named `obstacle_I_J`; I is 0 for sensors of what else stands on the floor.
    """
    for old in [sensor for sensor in spec.sensors if re.fullmatch(WALL, sensor.name)]:
        made = (spec.geom, spec.mesh) if old.name[9] != "0" else ()
        for part in filter(None, (*(find(old.name) for find in made), old)):
            spec.delete(part)
    standing = filter(spec.geom, {*fixed_geoms(robot.model)} - {floor})
    for j, name in enumerate(sorted(standing), start=1):
        _watch(spec, f"obstacle_0_{j}", (_GEOM, name), (_SUBTREE, robot.root))
    for i, obstacle in enumerate(obstacles, start=1):
        for j, piece in enumerate(obstacle.pieces, start=1):
            name = f"obstacle_{i}_{j}"
            _add_geom(spec, name, piece, obstacle.height)
            _watch(spec, name, (_GEOM, name), (_SUBTREE, robot.root))


def _add_geom(spec: mujoco.MjSpec, name: str, piece: Piece, height: float) -> None:
    middle, half = (height - SUNK) / 2, (height + SUNK) / 2
    if isinstance(piece, Box):
        shape = {
            "type": mujoco.mjtGeom.mjGEOM_BOX,
            "pos": (*piece.center, middle),
            "size": (*piece.half, half),
            "quat": (cos(piece.yaw / 2), 0, 0, sin(piece.yaw / 2)),
        }
    else:
        ends = [(*p, z) for p in piece.corners for z in (middle - half, middle + half)]
        spec.add_mesh(name=name, uservert=np.ravel(ends))
        shape = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}
    spec.worldbody.add_geom(
        name=name, rgba=COLOUR, contype=EVERYTHING, conaffinity=EVERYTHING, **shape
    )


class Touches:
    """Counts how often contacts begin: with obstacles, or those of other sensors."""

    def __init__(self, model: mujoco.MjModel, names: str = WALL) -> None:
        """Watch all sensors whose names match an expression."""
        sensors = (model.sensor(i) for i in range(model.nsensor))
        self._at = [s.adr[0] for s in sensors if re.fullmatch(names, s.name)]
        self._touching = np.zeros((1, len(self._at)), dtype=bool)
        self.count = 0

    def read(self, sensordata: Array) -> None:
        """Count contacts that begin in consecutive steps, shape (n, nsensordata)."""
        touching = np.concatenate([self._touching, sensordata[:, self._at] > 0])
        self.count += int((touching[1:] & ~touching[:-1]).sum())
        self._touching = touching[-1:]
