"""Short words for two fields X and Y whose only bracket is [X,Y].

The word of the paper follows the four sides of a rectangle, which realises the bracket,
and then flows along X and Y themselves. A word becomes shorter if some sides of the
rectangle also serve as the flows along X and Y and need not be undone. There are two
families of such words. The words Y^(hY-q) X^p Y^q X^(hX-p) reach the backward
coordinates hX, hY and p q; the words X^(hX+p) Y^q X^-p Y^(hY-q) reach hX, hY and
p q + hX hY. Only a few values of p can give the shortest word, so all of these are
compared. Up to brackets of degree 3, no word of any other form is shorter.
"""

from __future__ import annotations

import numpy as np

from planner.lie.input_words import ZERO_DURATION
from planner.numerics.arrays import Array


def short_durations(first: Array, second: Array, bracket: Array) -> Array:
    """Durations of the shortest word of five flows X, Y, X, Y, X, (segments, 5).

    Backward coordinates of X, Y and [X,Y] have shape (segments,). The first or the last
    duration is zero.
    """
    p, q = _rectangles(bracket, first, second)
    starting_with_second = np.stack([0 * p, second - q, p, q, first - p], axis=-1)
    p, q = _rectangles(bracket - first * second, -first, second)
    starting_with_first = np.stack([first + p, q, -p, second - q, 0 * p], axis=-1)
    words = np.concatenate([starting_with_second, starting_with_first])
    shortest = np.abs(words).sum(axis=-1).argmin(axis=0)
    return words[shortest, np.arange(len(first))]


def _rectangles(area: Array, width: Array, height: Array) -> tuple[Array, Array]:
    """Candidate sides p, q with p q = area, shape (candidates, segments).

    The length |p| + |p - width| + |q| + |q - height| is least for a square, or where a
    side makes one of the flows vanish.
    """
    area = np.where(np.abs(area) < ZERO_DURATION, 0.0, area)
    root = np.sqrt(np.abs(area))
    with np.errstate(divide="ignore", invalid="ignore"):
        p = np.stack([root, -root, width, area / height])
        q = area / p
    usable = np.isfinite(p) & np.isfinite(q)
    return np.where(usable, p, root), np.where(usable, q, np.sign(area) * root)
