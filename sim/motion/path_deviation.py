"""Deviation of poses from the nominal path of a scenario."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from planner import Array, Path
from planner.optimisation import deviation

POINTS = 1001  # of the path
GROUPS = ((0, 1), (2,))


class PathDeviation(NamedTuple):
    """Farthest from a path, and from its yaw."""

    position: float  # [m]
    yaw: float  # [rad]


def path_deviation(path: Path, poses: Array) -> PathDeviation:
    """Farthest that poses (T, 3) come from a path and from its yaw, both in order."""
    points = path.at(np.linspace(0.0, 1.0, POINTS))[:, :3]
    followed = poses.copy()
    followed[:, 2] = np.unwrap(poses[:, 2])
    return PathDeviation(*deviation(followed, points, GROUPS))
