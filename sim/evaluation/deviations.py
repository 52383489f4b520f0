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

    A plan follows the prediction it steers on, an optimised one at least the
    quasi-static.
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
    return Departure(
        position=float(np.hypot(*(pose - other)[:2])),
        yaw=float(abs(wrap(pose[2] - other[2]))),
    )


def off(poses: Array, others: Array, length: float, walked: float) -> PredictionError:
    """How far a motion is from another one at its end, and at most on the way.

    Both have shape (T, 3); ratios to lengths of the path and of the way walked [m] are
    None where these are zero.
    """
    at_end = departure(poses[-1], others[-1])
    return PredictionError(
        position=at_end.position,
        yaw=at_end.yaw,
        position_per_path=at_end.position / length if length else None,
        position_per_walked=at_end.position / walked if walked else None,
        farthest=float(np.hypot(*(poses - others)[:, :2].T).max()),
    )
