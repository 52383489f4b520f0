"""How high a robot can raise its feet, and by which angle of its lift joints."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.contact.kinematics import Kinematics
from planner import Array

TABLE = 1001  # angles up to the farthest; heights in between are interpolated


@dataclass(frozen=True)
class Lifting:
    """Lifts of all legs at once from the standing configuration, legs at swing 0."""

    kinematics: Kinematics

    @property
    def farthest(self) -> float:
        """Largest angle that all lift joints and servos reach, up to half a turn."""
        robot = self.kinematics.robot
        ends = [
            max(sign * (end - robot.standing_angle(joint)) for end in robot.span(joint))
            for joint, sign in zip(robot.lift_joints, robot.raise_sign, strict=True)
        ]
        return float(min(np.pi, *ends))

    def rise(self, angle: Array) -> Array:
        """How far each foot leaves the ground, shape (..., F) [m].

        Args:
            angle: Of the lift joints, shape (...) [rad].
        """
        groups = len(self.kinematics.robot.groups)
        lift = np.repeat(np.append(angle, 0.0)[:, None], groups, axis=1)
        height = self.kinematics.stance(np.zeros_like(lift), lift).height
        return (height[:-1] - height[-1]).reshape(*np.shape(angle), -1)

    @property
    def highest(self) -> float:
        """Height that every foot reaches [m]."""
        return float(self._table[1].max())

    def angle(self, height: float) -> float:
        """Least angle at which every foot is that high [rad].

        Raises:
            ValueError: If that is higher than the highest.
        """
        angles, rises = self._table
        if height > self.highest:
            raise ValueError(f"{height} m is above the highest, {self.highest} m")
        top = int(rises.argmax()) + 1
        return float(np.interp(height, rises[:top], angles[:top]))

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        angles = np.linspace(0, max(self.farthest, 0.0), TABLE)
        return angles, self.rise(angles).min(axis=1)
