"""Replanning: one straight segment from a reached state, within the legs' range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import RangeError
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.planning.algorithm import Plan, follow_path
from planner.planning.paths import line

SEGMENT_NODES = 9  # of a straight step; its inputs vary with the heading only
FINEST = 2.0**-20  # smallest part of the way to the target that a step may go


@dataclass(frozen=True)
class Step:
    """A plan of one segment from a state towards a target.

    Attributes:
        plan: Flows of the segment.
        fraction: Part of the way that it goes; 1 unless the limits allow less.
    """

    plan: Plan
    fraction: float


def plan_step(
    extended: ExtendedSystem, state: ArrayLike, target: ArrayLike, execution: Execution
) -> Step:
    """Plan one straight segment from a reached state, as far as limits allow.

    Args:
        extended: System to steer.
        state: Configuration reached, shape (n,).
        target: Configuration to go to, shape (n,).
        execution: How to carry it out; `finish=False` leaves the legs where they are at
            the end.

    Raises:
        RangeError: Even the smallest step leaves the limits.
    """
    try:
        return Step(_straight(extended, state, target, execution), 1.0)
    except RangeError as error:
        refusal = error
    state, target = np.asarray(state, float), np.asarray(target, float)
    best, low, high = None, 0.0, 1.0
    while high - low > max(FINEST, 1e-3 * low):
        middle = (low + high) / 2
        try:
            way = state + middle * (target - state)
            best, low = _straight(extended, state, way, execution), middle
        except RangeError as error:
            high, refusal = middle, error
    if best is None:
        raise refusal
    return Step(best, low)


def _straight(
    extended: ExtendedSystem, start: ArrayLike, goal: ArrayLike, execution: Execution
) -> Plan:
    return follow_path(extended, line(start, goal), 1, execution, SEGMENT_NODES)
