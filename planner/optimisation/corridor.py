"""How far a motion strays from a path whose points it passes in order.

A motion passes the points of a path in order if a point of the path can go along with
it that leaves out nothing and never turns back. The deviation in position is the least
distance that such a point can keep, Frechet's; heading is compared at the nearest of
the points that can go along.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.numerics.arrays import Array

ROUNDING = 1e-12  # of the deviation, when it is looked for again


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Coordinates that together stay within a distance of the path's.

    Attributes:
        coordinates: Their indices in the state.
        most: The largest distance; infinity leaves them free on the way.

    Raises:
        ValueError: The distance is not above zero.
    """

    coordinates: tuple[int, ...]
    most: float

    def __post_init__(self) -> None:
        if not self.most > 0:
            raise ValueError(f"tolerance is {self.most:g}; give a number above 0")


def deviation(
    states: Array, path: Array, groups: Sequence[Sequence[int]]
) -> tuple[float, ...]:
    """The farthest that states come from a path, its points passed in order.

    Args:
        states: In time order, shape (T, n); the first belongs to the path's start and
            the last to its end.
        path: Points along the path, shape (K, n); deviations are exact to half the
            distance between two of them.
        groups: Coordinates to compare together. The first group decides which point of
            the path goes along; others are compared at that point.

    Returns:
        The farthest for each group.
    """
    moved = np.append(True, (np.diff(states, axis=0) != 0).any(axis=1))
    states = states[moved]
    first = list(groups[0])
    most, along = _along(states[:, first], path[:, first])
    gaps = states - path[along]
    others = (np.linalg.norm(gaps[:, list(g)], axis=1).max() for g in groups[1:])
    return (most, *map(float, others))


def _along(states: Array, path: Array) -> tuple[float, Array]:
    """Frechet's distance, and the path's point that goes along with each state, (T,).

    No point that goes along can keep closer than the nearest one, and mostly that is
    all there is to it.
    """
    most = _least(states, path)
    forward = _reachable(states, path, most)
    if not forward[-1, -1]:
        most = _frechet(states, path)
        forward = _reachable(states, path, most)
    backward = _reachable(states[::-1], path[::-1], most)[::-1, ::-1]
    pairs = zip(states, forward & backward, strict=True)
    nearest = [np.where(on, _distances(x, path), np.inf).argmin() for x, on in pairs]
    return most, np.array(nearest)


def _least(states: Array, path: Array) -> float:
    """A distance that some state, or one of the ends, has from the path."""
    ends = _distances(states[[0, -1]], path[[0, -1]]).max()
    return float(max(ends, *(_distances(state, path).min() for state in states)))


def _distances(here: Array, there: Array) -> Array:
    gap = here - there
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", gap, gap)))


def _frechet(states: Array, path: Array) -> float:
    """The discrete Frechet distance, along the diagonals of all pairs."""
    rows, columns = len(states), len(path)
    last, before = np.full((2, columns + 1), np.inf)
    before[0] = -np.inf  # so that the first pair has something to come from
    for diagonal in range(rows + columns - 1):
        low, high = max(0, diagonal - rows + 1), min(diagonal, columns - 1) + 1
        i = np.arange(low, high)
        gap = _distances(states[diagonal - i], path[i])
        reached = np.minimum(np.minimum(last[i + 1], last[i]), before[i])
        before, last = last, np.full(columns + 1, np.inf)
        last[low + 1 : high + 1] = np.maximum(gap, reached)
    return float(last[-1])


def _reachable(states: Array, path: Array, most: float) -> Array:
    """Which point can have come along to which state, shape (T, K), bool."""
    most = most * (1 + ROUNDING)
    found = np.zeros((len(states), len(path)), dtype=bool)
    index = np.arange(len(path))
    entered = index == 0
    for row, state in zip(found, states, strict=True):
        free = _distances(state, path) <= most
        barred = np.maximum.accumulate(np.where(free, -1, index))
        begun = np.maximum.accumulate(np.where(free & entered, index, -1))
        row[:] = begun > barred
        entered = row | np.append(False, row[:-1])
    return found
