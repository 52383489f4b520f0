"""The largest deviation of a motion from a path that it follows in order.

Following a path in order means: while the motion goes on, a companion point travels
along the path from its start to its end. The companion may wait, but it neither skips a
part of the path nor turns back. The deviation in position is the smallest distance
within which some companion can stay of the motion; this is the Frechet distance. The
deviation in heading is measured at the companion point that is nearest in position.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.numerics.arrays import Array

SLACK = 1e-12  # relative, so that rounding does not exclude the largest distance


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Largest distance from the path, in a group of coordinates.

    Attributes:
        coordinates: Indices of the coordinates in the state.
        most: Largest Euclidean distance; infinity leaves the coordinates free.

    Raises:
        ValueError: The distance is not positive.
    """

    coordinates: tuple[int, ...]
    most: float

    def __post_init__(self) -> None:
        if not self.most > 0:
            raise ValueError(f"tolerance is {self.most:g}; give a number above 0")


def deviation(
    states: Array, path: Array, groups: Sequence[Sequence[int]]
) -> tuple[float, ...]:
    """The largest deviation of states from a path that they follow in order.

    Args:
        states: States in time order, shape (T, n); the first belongs to the path's
            start and the last to its end.
        path: Points along the path, shape (K, n); deviations are exact to half the
            distance between two of them.
        groups: Groups of coordinates. The first group, the position, determines the
            companion of each state; the others are compared at that point.

    Returns:
        The largest distance in each group.
    """
    moved = np.append(True, (np.diff(states, axis=0) != 0).any(axis=1))
    states = states[moved]
    first = list(groups[0])
    most, along = _along(states[:, first], path[:, first])
    gaps = states - path[along]
    others = (np.linalg.norm(gaps[:, list(g)], axis=1).max() for g in groups[1:])
    return (most, *map(float, others))


def gaps(states: Array, path: Array, groups: Sequence[Sequence[int]]) -> Array:
    """Distance of each state from its companion in each group, shape (T, G).

    The arguments are those of `deviation`.
    """
    first = list(groups[0])
    _, along = _along(states[:, first], path[:, first])
    apart = states - path[along]
    found = [np.linalg.norm(apart[:, list(group)], axis=1) for group in groups]
    return np.stack(found, axis=1)


def _along(states: Array, path: Array) -> tuple[float, Array]:
    """The Frechet distance, and the companion point of each state, shape (T,).

    A companion cannot be closer than the nearest point of the path. In most cases that
    distance can be kept, and the general algorithm is not needed.
    """
    apart = _distances(states[:, None], path[None])  # (T, K)
    most = _least(apart)
    forward = _reachable(apart, most)
    if not forward[-1, -1]:
        most = _frechet(apart)
        forward = _reachable(apart, most)
    backward = _reachable(apart[::-1, ::-1], most)[::-1, ::-1]
    nearest: Array = np.where(forward & backward, apart, np.inf).argmin(axis=1)
    return most, nearest


def _least(apart: Array) -> float:
    """A lower bound on the Frechet distance, from the ends and the farthest state."""
    return float(max(apart[0, 0], apart[-1, -1], apart.min(axis=1).max()))


def _distances(here: Array, there: Array) -> Array:
    squares = sum((here[..., i] - there[..., i]) ** 2 for i in range(here.shape[-1]))
    distances: Array = np.sqrt(squares)
    return distances


def _frechet(apart: Array) -> float:
    """The discrete Frechet distance, along the diagonals of all pairs, (T, K)."""
    rows, columns = apart.shape
    last, before = np.full((2, columns + 1), np.inf)
    before[0] = -np.inf  # so that the first pair has something to come from
    for diagonal in range(rows + columns - 1):
        low, high = max(0, diagonal - rows + 1), min(diagonal, columns - 1) + 1
        i = np.arange(low, high)
        gap = apart[diagonal - i, i]
        reached = np.minimum(np.minimum(last[i + 1], last[i]), before[i])
        before, last = last, np.full(columns + 1, np.inf)
        last[low + 1 : high + 1] = np.maximum(gap, reached)
    return float(last[-1])


def _reachable(apart: Array, most: float) -> Array:
    """Which point can be the companion of which state, shape (T, K), bool."""
    free = apart <= most * (1 + SLACK)
    index = np.arange(apart.shape[1], dtype=np.int32)
    barred = np.maximum.accumulate(np.where(free, np.int32(-1), index), axis=1)
    found = np.zeros(apart.shape, dtype=bool)
    entered = index == 0
    for row, open_, bar in zip(found, free, barred, strict=True):
        begun = np.maximum.accumulate(np.where(open_ & entered, index, -1))
        np.greater(begun, bar, out=row)
        entered = row.copy()
        entered[1:] |= row[:-1]
    return found
