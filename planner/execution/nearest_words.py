"""Of several exact words for a segment, the one that ends nearest to its goal.

Words of an approximation of degree k miss brackets of degree k + 1. The error of two
orders of the same flows may differ a hundredfold, and which one is the smaller depends
on the goal, so each candidate is rolled out. That costs time, and is done only where
the degree is raised above that of the elements, for the sake of accuracy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.errors import ConvergenceError
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Wording
from planner.numerics.arrays import Array
from planner.numerics.budget import tick
from planner.systems.flows import Word, flow_map
from planner.systems.strata import StratifiedSystem

ORDERS: tuple[Wording, ...] = (
    "backward", "forward", "backward-turned", "forward-turned",
)  # fmt: skip


def nearest_words(
    extended: ExtendedSystem, hall_coordinates: Array, nominal: Array
) -> list[Word]:
    """The word of each segment, among all orders, that ends nearest to its goal.

    Args:
        extended: System that the coordinates are of.
        hall_coordinates: Backward coordinates, shape (segments, s).
        nominal: Configurations between segments, shape (segments + 1, n).
    """
    steering = extended.steering
    starts, goals = nominal[:-1], nominal[1:]
    ways = [steering.words(hall_coordinates, order, starts) for order in ORDERS]
    return [
        _nearest(extended.system, words, start, goal)
        for words, start, goal in zip(
            zip(*ways, strict=True), starts, goals, strict=True
        )
    ]


def _nearest(
    system: StratifiedSystem, words: Sequence[Word], start: Array, goal: Array
) -> Word:
    tick()
    misses = [_miss(system, word, start, goal) for word in words]
    return words[int(np.argmin(misses))]


def _miss(system: StratifiedSystem, word: Word, start: Array, goal: Array) -> float:
    """Distance of the end of a word from the goal; infinite where it escapes."""
    state = start
    try:
        for name, duration in zip(word.fields, word.durations, strict=True):
            state = flow_map(system, name, state, duration)
    except ConvergenceError:
        return np.inf
    return float(np.linalg.norm(state - goal))
