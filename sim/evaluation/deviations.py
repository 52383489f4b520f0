"""Deviations of a walk from its nominal path, and what each metre of the path costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from planner import Array, Path
from sim.evaluation.summary import Departure, PerMetre, PredictionError
from sim.motion.path_deviation import path_deviation
from sim.motion.poses import wrap
from sim.scenarios.predictions import IDEAL, QUASI_STATIC
from sim.scenarios.scenario import Scenario

COMPARED = 1500  # poses that are compared with the path, evenly taken from all


def deviations(
    scenario: Scenario, deviation_of: Mapping[str, Callable[[], Departure]]
) -> dict[str, Departure | None]:
    """Farthest from the path and from its yaw: planned, quasi-static and achieved.

    Args:
        scenario: What was to be walked; its plan follows the prediction it steers on,
            and an optimised one at least the quasi-static.
        deviation_of: Path deviation of each prediction and of what was achieved.
    """
    planned = scenario.steered_on
    if planned == IDEAL.key and scenario.optimise != "none":
        planned = QUASI_STATIC.key
    asked = {
        "planned": planned,
        "quasi_static": QUASI_STATIC.key,
        "achieved": "achieved",
    }
    return {
        key: deviation_of[name]() if name in deviation_of else None
        for key, name in asked.items()
    }


def deviation_from(curve: Path, poses: Array) -> Departure:
    """Farthest that poses come from a path, and from its yaw.

    Args:
        curve: Nominal poses.
        poses: In time order, shape (T, 3).
    """
    count = min(len(poses), COMPARED)
    rows = np.linspace(0, len(poses) - 1, count).round().astype(int)
    return Departure(**path_deviation(curve, poses[rows])._asdict())


def per_metre(length: float, seconds: float, strokes: float) -> PerMetre:
    """Time and strokes per metre of the nominal path.

    Args:
        length: Of the path [m].
        seconds: From the first lift-off to the last touchdown.
        strokes: Way of the loaded groups' angles [rad].
    """
    if not length:
        return PerMetre()
    return PerMetre(seconds=seconds / length, strokes=strokes / length)


def departure(pose: Array, other: Array) -> Departure:
    """How far a pose is from another one.

    Args:
        pose: x [m], y [m], yaw [rad].
        other: Likewise.
    """
    return Departure(
        position=float(np.hypot(*(pose - other)[:2])),
        yaw=float(abs(wrap(pose[2] - other[2]))),
    )


def off(poses: Array, others: Array, length: float, walked: float) -> PredictionError:
    """How far a motion is from another one at its end, and at most on the way.

    Args:
        poses: Shape (T, 3).
        others: Shape (T, 3), at the same moments.
        length: Of the nominal path [m]; ratios to a length of zero are None.
        walked: Length of the way of the ideal body centre [m].
    """
    at_end = departure(poses[-1], others[-1])
    return PredictionError(
        position=at_end.position,
        yaw=at_end.yaw,
        position_per_path=at_end.position / length if length else None,
        position_per_walked=at_end.position / walked if walked else None,
        farthest=float(np.hypot(*(poses - others)[:, :2].T).max()),
    )
