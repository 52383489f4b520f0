"""The outline of a robot seen from above, for given poses and angles of its legs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from models import Robot
from planner import Array
from sim.obstacles.solids import Solids


@dataclass(frozen=True)
class Outline:
    """A robot in a model, and the floor that it covers."""

    robot: Robot
    model: mujoco.MjModel

    @cached_property
    def solids(self) -> Solids:
        """Its solid parts."""
        return Solids(self.model, self.model.body(self.robot.root).id)

    @cached_property
    def _root(self) -> int:
        """Where the free joint's positions begin."""
        return self.robot.root_address_in(self.model)

    def configurations(self, pose: Array, swing: Array, lift: Array) -> Array:
        """Joint positions of a level body.

        Args:
            pose: x, y [m], yaw [rad], shape (T, 3).
            swing: Angle of each group, shape (T, G) [rad].
            lift: How far each group is raised, shape (T, G) [rad].

        Returns:
            Shape (T, nq).
        """
        robot, model = self.robot, self.model
        qpos = np.tile(robot.start_qpos, (len(pose), 1))
        root = self._root
        qpos[:, root : root + 2] = pose[:, :2]
        half, zero = pose[:, 2] / 2, np.zeros(len(pose))
        upright = [np.cos(half), zero, zero, np.sin(half)]
        qpos[:, root + 3 : root + 7] = np.stack(upright, axis=-1)
        for joint, angle in robot.leg_angles(swing, lift).items():
            qpos[:, model.joint(joint).qposadr[0]] += angle
        return qpos

    def radius(self, qpos: Array) -> float:
        """Radius of the circle about the root's origin that contains the robot [m]."""
        center, cores = qpos[self._root : self._root + 2], self.solids.cores(qpos[None])
        return max(
            float(np.linalg.norm(core[0] - center, axis=-1).max()) + part.radius
            for core, part in zip(cores, self.solids.parts, strict=True)
        )
