"""The largest deviation of a motion from a path that it follows in order.

While the motion goes on, a companion point travels along the path from its start to its
end. It may wait, but it neither skips a part of the path nor turns back. The deviation
in position is the smallest distance within which some companion can stay of the motion,
the Frechet distance; that in heading is measured at the nearest of such points.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.numerics.arrays import Array

SLACK = 1e-12  # relative, so that rounding does not exclude the largest distance
TIED = 1e-9  # of other coordinates, by which points at equal distances are told apart


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Largest distance from the path, in a group of coordinates."""

    coordinates: tuple[int, ...]  # indices in the state
    most: float  # Euclidean distance; infinity leaves the coordinates free

    def __post_init__(self) -> None:
        if not self.most > 0:
            raise ValueError(f"tolerance is {self.most:g}; give a number above 0")


def deviation(
    states: Array, path: Array, groups: Sequence[Sequence[int]]
) -> tuple[float, ...]:
    """The largest deviation of states from a path in each group of coordinates.

    States (T, n) are in time order; the first belongs to the path's start and the last
    to its end. Deviations are exact to half the distance between two of the path's
    points (K, n). The first group, the position, determines the companion of each
    state, and the others do where positions are alike, as in a turn on the spot.
    """
    moved = np.append(True, (np.diff(states, axis=0) != 0).any(axis=1))
    most, found = _followed(states[moved], path, groups)
    return (most, *found[:, 1:].max(axis=0).tolist())


def gaps(states: Array, path: Array, groups: Sequence[Sequence[int]]) -> Array:
    """Distance of each state from its companion in each group, shape (T, G)."""
    return _followed(states, path, groups)[1]


def _followed(
    states: Array, path: Array, groups: Sequence[Sequence[int]]
) -> tuple[float, Array]:
    """The Frechet distance in the first group, and `gaps`.

    A companion cannot be closer than the nearest point of the path. In most cases that
    distance can be kept, and the general algorithm is not needed.
    """
    apart, *others = (  # (T, K) each
        np.sqrt(sum((states[:, None, i] - path[None, :, i]) ** 2 for i in group))
        for group in groups
    )
    most = float(max(apart[0, 0], apart[-1, -1], apart.min(axis=1).max()))
    forward = _reachable(apart, most)
    if not forward[-1, -1]:
        most = _frechet(apart)
        forward = _reachable(apart, most)
    backward = _reachable(apart[::-1, ::-1], most)[::-1, ::-1]
    allowed = np.where(forward & backward, apart + TIED * sum(others), np.inf)
    own = np.arange(len(states)), allowed.argmin(axis=1)
    return most, np.stack([each[own] for each in (apart, *others)], axis=1)


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
