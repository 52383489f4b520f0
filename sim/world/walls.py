"""Obstacles in the model: solid geoms, and sensors of their contact with the robot."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin

import mujoco
import numpy as np

from planner import Array
from sim.scenarios.obstacles import Box, Obstacle, Piece

PREFIX = "obstacle_"
COLOUR = (0.45, 0.48, 0.53, 1.0)
EVERYTHING = 2**31 - 1  # all contact types
SUNK = 0.01  # [m] below the floor, so that no gap is visible


def add_walls(spec: mujoco.MjSpec, root: str, obstacles: Sequence[Obstacle]) -> None:
    """Replace the obstacles of a world, with a contact sensor for every piece.

    Geoms are named `obstacle_I_J`, both from 1; the root body carries the robot.
    """
    for old in (*spec.worldbody.geoms, *spec.sensors, *spec.meshes):
        if old.name.startswith(PREFIX):
            spec.delete(old)
    for i, obstacle in enumerate(obstacles, start=1):
        for j, piece in enumerate(obstacle.pieces, start=1):
            name = f"{PREFIX}{i}_{j}"
            _add_geom(spec, name, piece, obstacle.height)
            spec.add_sensor(
                name=name,
                type=mujoco.mjtSensor.mjSENS_CONTACT,
                objtype=mujoco.mjtObj.mjOBJ_GEOM,
                objname=name,
                reftype=mujoco.mjtObj.mjOBJ_XBODY,  # its whole subtree
                refname=root,
                intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 0, 1],
            )


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
        ends = [(*p, z) for p in piece.points for z in (middle - half, middle + half)]
        spec.add_mesh(name=name, uservert=np.ravel(ends))
        shape = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}
    spec.worldbody.add_geom(
        name=name, rgba=COLOUR, contype=EVERYTHING, conaffinity=EVERYTHING, **shape
    )


class Touches:
    """Counts how often contacts begin: with obstacles, or those of other sensors."""

    def __init__(self, model: mujoco.MjModel, prefix: str = PREFIX) -> None:
        """Watch all sensors whose names begin with the prefix."""
        sensors = (model.sensor(i) for i in range(model.nsensor))
        self._at = [s.adr[0] for s in sensors if s.name.startswith(prefix)]
        self._touching = np.zeros((1, len(self._at)), dtype=bool)
        self.count = 0

    def read(self, sensordata: Array) -> None:
        """Count contacts that begin in consecutive steps, shape (n, nsensordata)."""
        touching = np.concatenate([self._touching, sensordata[:, self._at] > 0])
        self.count += int((touching[1:] & ~touching[:-1]).sum())
        self._touching = touching[-1:]
