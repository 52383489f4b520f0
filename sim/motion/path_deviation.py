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
    """Farthest from the nominal path and from its yaw, the path's points in order.

    Args:
        path: Nominal poses.
        poses: In time order, yaw up to full turns, shape (T, 3).
    """
    points = path.at(np.linspace(0.0, 1.0, POINTS))[:, :3]
    followed = poses.copy()
    followed[:, 2] = np.unwrap(poses[:, 2])
    return PathDeviation(*deviation(followed, points, GROUPS))
