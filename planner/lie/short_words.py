"""Short words for one pair of fields that do not commute: sweeps and bracket in one.

The printed words run a bracket's rectangle and then the sweeps of its fields. Let into
one another they are shorter: the sweeps are what the rectangle does not take back. The
words Y^(hY-q) X^p Y^q X^(hX-p) reach coordinates hX, hY and p q, the words
X^(hX+p) Y^q X^-p Y^(hY-q) reach hX, hY and p q + hX hY; the shortest has one of few p,
and up to brackets of degree 3 no word of any length is shorter.
"""

from __future__ import annotations

import numpy as np

from planner.lie.words import NEGLIGIBLE
from planner.numerics.arrays import Array


def short_durations(first: Array, second: Array, bracket: Array) -> Array:
    """Durations of the shortest word of five flows X, Y, X, Y, X.

    Args:
        first: Backward coordinates of the earlier field X, shape (segments,).
        second: Those of the later field Y, shape (segments,).
        bracket: Those of [X,Y], shape (segments,).

    Returns:
        Shape (segments, 5); at least one of the outer flows has no duration.
    """
    p, q = _rectangles(bracket, first, second)
    starting_with_second = np.stack([0 * p, second - q, p, q, first - p], axis=-1)
    p, q = _rectangles(bracket - first * second, -first, second)
    starting_with_first = np.stack([first + p, q, -p, second - q, 0 * p], axis=-1)
    words = np.concatenate([starting_with_second, starting_with_first])
    shortest = np.abs(words).sum(axis=-1).argmin(axis=0)
    durations: Array = words[shortest, np.arange(len(first))]
    return durations


def _rectangles(area: Array, width: Array, height: Array) -> tuple[Array, Array]:
    """Candidate sides p, q with p q = area, shape (candidates, segments).

    The length |p| + |p - width| + |q| + |q - height| is least at a square or where one
    side makes a flow vanish.
    """
    area = np.where(np.abs(area) < NEGLIGIBLE, 0.0, area)
    root = np.sqrt(np.abs(area))
    with np.errstate(divide="ignore", invalid="ignore"):
        p = np.stack([root, -root, width, area / height])
        q = area / p
    usable = np.isfinite(p) & np.isfinite(q)
    return np.where(usable, p, root), np.where(usable, q, np.sign(area) * root)
