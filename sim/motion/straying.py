"""How far poses stray from the nominal path of a scenario."""

from __future__ import annotations

import numpy as np

from planner import Array, Path
from planner.optimisation import deviation

POINTS = 1001  # of the path
GROUPS = ((0, 1), (2,))


def straying(path: Path, poses: Array) -> dict[str, float]:
    """Farthest from the nominal path and from its yaw, the path's points in order.

    Args:
        path: Nominal poses.
        poses: In time order, yaw up to full turns, shape (T, 3).

    Returns:
        `position` [m] and `yaw` [rad].
    """
    points = path.at(np.linspace(0.0, 1.0, POINTS))[:, :3]
    followed = poses.copy()
    followed[:, 2] = np.unwrap(poses[:, 2])
    position, yaw = deviation(followed, points, GROUPS)
    return {"position": position, "yaw": yaw}
