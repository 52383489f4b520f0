"""Distances of poses from others and from the nominal path, and per metre of it."""

from __future__ import annotations

import numpy as np

from planner import Array, Path
from sim.evaluation.summary import Departure, PerMetre, PredictionError
from sim.motion.path_deviation import path_deviation
from sim.motion.poses import wrap

COMPARED = 1500  # poses that are compared with the path, evenly taken from all


def deviation_from(curve: Path, poses: Array) -> Departure:
    """Farthest that poses, in time order, come from a path and from its yaw."""
    count = min(len(poses), COMPARED)
    rows = np.linspace(0, len(poses) - 1, count).round().astype(int)
    return Departure(**path_deviation(curve, poses[rows])._asdict())


def per_metre(length: float, seconds: float, strokes: float) -> PerMetre:
    """Time and strokes of the loaded groups [rad] per metre of the nominal path."""
    if not length:
        return PerMetre()
    return PerMetre(seconds=seconds / length, strokes=strokes / length)


def departure(pose: Array, other: Array) -> Departure:
    """How far a pose is from another one."""
    apart = pose - other
    return Departure(
        position=float(np.hypot(*apart[:2])), yaw=float(abs(wrap(apart[2])))
    )


def off(poses: Array, others: Array, length: float, walked: float) -> PredictionError:
    """How far a motion is from another one at its end, and at most on the way.

    Both have shape (T, 3); ratios to lengths of the path and of the way walked [m] are
    None where these are zero.
    """
    at_end = departure(poses[-1], others[-1])
    return PredictionError(
        **at_end,
        position_per_path=at_end.position / length if length else None,
        position_per_walked=at_end.position / walked if walked else None,
        farthest=float(np.hypot(*(poses - others)[:, :2].T).max()),
    )
