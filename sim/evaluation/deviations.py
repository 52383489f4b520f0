"""Deviations of a walk from its nominal path, and what each metre of the path costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from planner import Array, Path
from sim.motion.poses import wrap
from sim.motion.straying import straying
from sim.scenarios.scenario import Scenario

MOST = 1500  # poses that are compared, evenly taken from all
Strays = dict[str, float]


def deviations(
    scenario: Scenario, strayed: Mapping[str, Callable[[], Strays]]
) -> dict[str, Strays | None]:
    """Farthest from the path and from its yaw: planned, quasi-static and achieved.

    Args:
        scenario: What was to be walked; its plan follows the prediction it steers on,
            and an optimised one at least the quasi-static.
        strayed: How far each prediction strays, and what was achieved; by name.
    """
    name = scenario.steered_on
    if name == "ideal" and scenario.optimise != "none":
        name = "quasi_static"
    asked = {"planned": name, "quasi_static": "quasi_static", "achieved": "achieved"}
    return {
        key: strayed[name]() if name in strayed else None for key, name in asked.items()
    }


def strays(curve: Path, poses: Array) -> Strays:
    """How far poses stray from a path, and from its yaw.

    Args:
        curve: Nominal poses.
        poses: In time order, shape (T, 3).

    Returns:
        `position` [m] and `yaw` [rad].
    """
    rows = np.linspace(0, len(poses) - 1, min(len(poses), MOST)).round().astype(int)
    return straying(curve, poses[rows])


def per_metre(length: float, seconds: float, strokes: float) -> dict[str, Any]:
    """Time and strokes per metre of the nominal path; None where it has no length.

    Args:
        length: Of the path [m].
        seconds: From the first lift-off to the last touchdown.
        strokes: Way of the loaded groups' angles [rad].
    """
    return {
        "seconds": seconds / length if length else None,
        "strokes": strokes / length if length else None,
    }


def departure(pose: Array, other: Array) -> dict[str, float]:
    """How far a pose is from another one: position [m] and yaw [rad].

    Args:
        pose: x [m], y [m], yaw [rad].
        other: Likewise.
    """
    return {
        "position": float(np.hypot(*(pose - other)[:2])),
        "yaw": float(abs(wrap(pose[2] - other[2]))),
    }


def off(poses: Array, others: Array, length: float, walked: float) -> dict[str, Any]:
    """How far a motion is from another one at its end, and at most on the way.

    Args:
        poses: Shape (T, 3).
        others: Shape (T, 3), at the same moments.
        length: Of the nominal path [m]; ratios to a length of zero are None.
        walked: Length of the way of the ideal body centre [m].
    """
    at_end = departure(poses[-1], others[-1])
    position = at_end["position"]
    return at_end | {
        "position_per_path": position / length if length else None,
        "position_per_walked": position / walked if walked else None,
        "farthest": float(np.hypot(*(poses - others)[:, :2].T).max()),
    }
