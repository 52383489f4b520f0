"""The common task of different planners: the hexapod's body moves along arcs.

A loaded tripod swings the body along a circle, tripod 1 to the left and tripod 2 to the
right, forward and back. Legs in the air may swing at no cost, so that a plan is a
sequence of strokes under load whose cost is the angle swept.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner import Array

Pose = tuple[float, float, float]  # x, y, yaw [rad]
Stroke = tuple[int, float]  # 1 for tripod 1, -1 for tripod 2; angle [rad]
START: Pose = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Arcs:
    """Two circles that touch in the middle of the body."""

    stride: float  # way for a radian of swing
    yaw_gain: float  # [rad/rad]

    @property
    def radius(self) -> float:
        """Radius of both circles."""
        return self.stride / self.yaw_gain

    def after(self, pose: Any, side: int, swing: Any, functions: Any = np) -> list[Any]:
        """The pose after a stroke, in numbers or in symbols.

        Args:
            pose: x, y, yaw [rad].
            side: 1 for tripod 1, -1 for tripod 2.
            swing: Angle of the stroke [rad].
            functions: Module that has `sin` and `cos` for the pose.
        """
        x, y, yaw = pose[0], pose[1], pose[2]
        turned = yaw + side * self.yaw_gain * swing
        radius = side * self.radius
        return [
            x + radius * (functions.sin(turned) - functions.sin(yaw)),
            y - radius * (functions.cos(turned) - functions.cos(yaw)),
            turned,
        ]


@dataclass(frozen=True, slots=True)
class Task:
    """Reach a pose from the origin.

    Attributes:
        name: What the task is called.
        arcs: How strokes move the body.
        goal: Pose to reach, in the unit of the arcs and radians.
    """

    name: str
    arcs: Arcs
    goal: Pose

    def poses(self, strokes: Sequence[Stroke]) -> Array:
        """The start and the pose after each stroke, shape (1 + strokes, 3)."""
        poses = [list(START)]
        for side, swing in strokes:
            poses.append(self.arcs.after(poses[-1], side, swing))
        return np.array(poses)

    def error(self, strokes: Sequence[Stroke]) -> float:
        """Distance from the goal at the end, yaw counted at the circles' radius."""
        x, y, yaw = self.poses(strokes)[-1] - self.goal
        return math.hypot(x, y, self.arcs.radius * math.remainder(yaw, math.tau))


def travel(strokes: Sequence[Stroke]) -> float:
    """Swing travel under load [rad]."""
    return sum(abs(swing) for _, swing in strokes)


def joined(strokes: Sequence[Stroke]) -> list[Stroke]:
    """Successive strokes of one tripod joined; those that cancel disappear."""
    together: list[Stroke] = []
    for side, swing in strokes:
        if together and together[-1][0] == side:
            swing += together.pop()[1]
        if swing:
            together.append((side, swing))
    return together
