"""The assignment of actuators to legs: commands for angles of groups, and back."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from models import Robot
from models.description import actuator_of


@dataclass(frozen=True)
class Channels:
    """Commands of a model: the places of its leg joints in ctrl."""

    robot: Robot
    model: mujoco.MjModel

    def ctrl(self, swing: np.ndarray, lift: np.ndarray) -> np.ndarray:
        """Commands of every actuator.

        Args:
            swing: Angle of each group, shape (T, G) [rad].
            lift: How far each group is raised, shape (T, G) [rad].

        Returns:
            Shape (T, nu); actuators of other joints keep the keyframe's value.
        """
        robot, model = self.robot, self.model
        rows = np.tile(model.key("start").ctrl, (len(swing), 1))
        for joint, angle in robot.leg_angles(swing, lift).items():
            rows[:, actuator_of(model, joint)] = robot.standing_angle(joint) + angle
        for leg in robot.card.legs.values():
            for joint in leg.hold:
                rows[:, actuator_of(model, joint)] = robot.standing_angle(joint)
        return np.ascontiguousarray(rows)

    def swing(self, qpos: np.ndarray) -> np.ndarray:
        """Actual angles of the groups; servos lag behind their commands.

        Args:
            qpos: Shape (T, nq).

        Returns:
            Mean angle of each group's legs, shape (T, G) [rad].
        """
        robot = self.robot
        joints = robot.swing_joints
        places = [int(self.model.joint(joint).qposadr[0]) for joint in joints]
        standing = np.array([robot.standing_angle(joint) for joint in joints])
        legs = (qpos[:, places] - standing) / robot.swing_gain  # (T, F)
        groups = range(len(robot.groups))
        means = [legs[:, robot.group_of_leg == g].mean(axis=1) for g in groups]
        return np.stack(means, axis=1)
