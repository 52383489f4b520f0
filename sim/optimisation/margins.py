"""The stability margin as expressions that a solver can differentiate.

The weight keeps a distance from every side of the support polygon. Which feet make the
sides is read off the robot with its legs at angle 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import permutations
from typing import Any

import numpy as np

from models import Kinematics
from planner import Array
from planner.optimisation import Stage
from sim.preparation.setup import Setup

FIRST_ANGLE = 3  # of the state, after the pose


def margins(setup: Setup, least: float) -> Callable[[Stage, Sequence[Any]], list[Any]]:
    """What the weight is farther from each side than a least margin [m].

    Args:
        setup: Robot and lift.
        least: Margin to keep [m].

    Returns:
        Expressions that must not be negative, from a stage and a state's entries.
    """
    robot, kinematics = setup.robot, setup.kinematics

    def of(stage: Stage, state: Sequence[Any]) -> list[Any]:
        planted = robot.planted(stage.stratum)
        angles = [state[FIRST_ANGLE + g] for g in robot.group_of_leg]
        raised = np.where(planted, 0.0, setup.limits.lift_angle) * robot.raise_sign
        feet, center = _places(kinematics, angles, raised)
        return [
            _beyond(feet[i], feet[j], center) - least
            for i, j in _sides(kinematics, planted)
        ]

    return of


def _sides(kinematics: Kinematics, planted: Array) -> Iterator[tuple[int, int]]:
    """Pairs of feet that have all others on their left."""
    groups = len(kinematics.robot.groups)
    feet = kinematics.stance(np.zeros(groups)).feet
    standing = np.flatnonzero(planted)
    for i, j in permutations(standing.tolist(), 2):
        others = [k for k in standing if k not in (i, j)]
        if all(_beyond(feet[i], feet[j], feet[k]) > 0 for k in others):
            yield i, j


def _beyond(begin: Sequence[Any], end: Sequence[Any], point: Sequence[Any]) -> Any:
    """Distance of a point to the left of a line."""
    along = end[0] - begin[0], end[1] - begin[1]
    out = point[0] - begin[0], point[1] - begin[1]
    length = (along[0] * along[0] + along[1] * along[1]) ** 0.5
    return (along[0] * out[1] - along[1] * out[0]) / length


def _places(
    kinematics: Kinematics, angles: Sequence[Any], raised: Array
) -> tuple[list[tuple[Any, Any]], tuple[Any, Any]]:
    """Where the feet and the centre of mass are, as expressions."""
    foot, weight = kinematics.foot_terms, kinematics.weight_terms
    feet = []
    x, y = map(float, kinematics.center_of_mass[:2])
    center: tuple[Any, Any] = (x, y)
    for leg, (angle, lift) in enumerate(zip(angles, raised, strict=True)):
        swing = angle * float(kinematics.robot.swing_gain[leg])
        place = _sum(foot[leg], swing, float(lift))
        moved = _sum(weight[leg], swing, float(lift))
        feet.append(place)
        center = center[0] + moved[0], center[1] + moved[1]
    return feet, center


def _sum(terms: Array, swing: Any, lift: float) -> tuple[Any, Any]:
    """A leg's terms (3, 3, 3) at a swing to be solved for and a given lift."""
    by_swing = np.einsum("abi,b->ai", terms, [1.0, np.cos(lift), np.sin(lift)])
    import casadi  # loaded by now: its symbols are what a swing is

    basis = (1.0, casadi.cos(swing), casadi.sin(swing))
    x, y = (sum(float(by_swing[a, i]) * basis[a] for a in range(3)) for i in range(2))
    return x, y
