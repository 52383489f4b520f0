"""Of several exact words for a segment, the one that ends nearest to its goal.

Words of an approximation of degree k miss brackets of degree k + 1. The error of two
orders of the same flows may differ a hundredfold, and which one is the smaller depends
on the goal and on the fields, so the words are played, with each generator run forward
or backward first. That costs some rollouts a segment, which only a degree beyond that
of the elements is worth: it is asked for where accuracy matters. Signs are chosen once
for all segments of a plan, on a sample of them, where there are many, or the elements
alone are of degree 3 and more.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from planner.errors import ConvergenceError
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Spelled
from planner.numerics.arrays import Array
from planner.support.stopping import tick
from planner.systems.flows import Word, flow_map
from planner.systems.strata import StratifiedSystem

SAMPLE = 8  # segments whose words are played
EQUAL = 1e-6  # relative difference of misses that is taken for rounding
AS_GOOD = 1.02  # times the smallest miss, with which the printed signs are kept
ORDERS: tuple[Spelled, ...] = (
    "backward", "forward", "backward-turned", "forward-turned",
)  # fmt: skip


def nearest_words(
    extended: ExtendedSystem, hall_coordinates: Array, nominal: Array
) -> list[Word]:
    """The word of each segment, in any order and signs, that ends nearest to its goal.

    Takes backward coordinates, shape (segments, s), and the configurations between
    segments, shape (segments + 1, n).
    """
    steering = extended.steering
    every = list(steering.signs)
    if len(hall_coordinates) > SAMPLE:
        every = [nearest_signs(extended, hall_coordinates, nominal, ORDERS)]
    hall_coordinates, units = steering.measured(hall_coordinates, nominal[:-1])
    ways = [
        steering.scaled_words(hall_coordinates, order, units * signs)
        for signs in every
        for order in ORDERS
    ]
    nearest = list[Word]()
    ends = pairwise(nominal)
    for words, (start, goal) in zip(zip(*ways, strict=True), ends, strict=True):
        tick()
        misses = [_miss(extended.system, word, start, goal) for word in words]
        # words that mirror one another miss alike, and in turn they make up for that
        equal = np.flatnonzero(np.array(misses) <= min(misses) * (1.0 + EQUAL))
        nearest.append(words[equal[-(len(nearest) % 2)]])
    return nearest


def nearest_signs(
    extended: ExtendedSystem,
    hall_coordinates: Array,
    nominal: Array,
    orders: Sequence[Spelled],
) -> Array:
    """Signs (m,) of the generators with which words in the orders end nearest to goals.

    They are those of the units themselves where these are as good as any.
    """
    steering, count = extended.steering, len(hall_coordinates)
    sample = np.unique(np.linspace(0, count - 1, SAMPLE).round().astype(int))
    starts, goals = nominal[sample], nominal[sample + 1]
    coordinates, units = (
        each[sample] for each in steering.measured(hall_coordinates, nominal[:-1])
    )

    def miss(signs: Array, order: Spelled) -> float:
        tick()
        words = steering.scaled_words(coordinates, order, units * signs)
        segments = zip(words, starts, goals, strict=True)
        return sum(_miss(extended.system, *segment) for segment in segments)

    misses = [min(miss(signs, order) for order in orders) for signs in steering.signs]
    best = _least(misses)
    return steering.signs[0 if misses[0] <= misses[best] * AS_GOOD else best]


def _least(misses: Sequence[float]) -> int:
    """The first of the smallest; words that mirror one another miss alike."""
    return int(np.argmax(np.array(misses) <= min(misses) * (1.0 + EQUAL)))


def _miss(system: StratifiedSystem, word: Word, start: Array, goal: Array) -> float:
    """Distance of the end of a word from the goal; infinite where it escapes."""
    state = start
    try:
        for name, duration in zip(word.fields, word.durations, strict=True):
            state = flow_map(system, name, state, duration)
    except ConvergenceError:
        return np.inf
    return float(system.length(state - goal))
