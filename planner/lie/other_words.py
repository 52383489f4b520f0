"""Words that reach the same Hall coordinates as the paper's, shorter or mirrored."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from planner.lie.coordinates import backward_from_forward
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import Element
from planner.lie.input_words import ZERO_DURATION, Spelling, spellings
from planner.numerics.arrays import Array


def mirrored_spellings(
    basis: Sequence[Element],
    hall_coordinates: Array,
    bracket_degree: int,
    vanishing: Collection[Element] = (),
) -> list[Spelling]:
    """Mirror images of backward words, which realise the same backward coordinates.

    Changing the sign of all generators multiplies an element of degree d by (-1)^d, and
    reversing the order of the flows by (-1)^(d + 1). The former leaves brackets of even
    degree unchanged, the latter those of odd degree; `bracket_degree`, of those that
    the words approximate, chooses between them. A word that is exact to a degree of the
    same parity misses its goal by brackets of one degree more, and this error changes
    its sign: a word and its mirror image together cancel it, without further flows.
    Coordinates have shape (segments, s); `vanishing` is as in `lie.input_words.word`.
    """
    signs = (-1.0) ** np.array(lie_algebra(tuple(basis)).degrees)
    if bracket_degree % 2 == 0:
        words = spellings(basis, hall_coordinates * signs, "backward", vanishing)
        return [(letters, [-t for t in times]) for letters, times in words]
    turned = backward_from_forward(basis, -signs * hall_coordinates)
    words = spellings(basis, turned, "backward", vanishing)
    return [(letters[::-1], times[::-1]) for letters, times in words]


def short_durations(first: Array, second: Array, bracket: Array) -> Array:
    """Durations of the shortest word of five flows X, Y, X, Y, X, (segments, 5).

    It is for two fields whose only bracket is [X,Y], in backward coordinates hX, hY and
    h of shape (segments,). Sides of the rectangle that realises the bracket also serve
    as the flows along X and Y: Y^(hY-q) X^p Y^q X^(hX-p) with p q = h, or
    X^(hX+p) Y^q X^-p Y^(hY-q) with p q = h - hX hY. No word of any other form is
    shorter up to brackets of degree 3.
    """
    p, q = _rectangles(bracket, first, second)
    starting_with_second = np.stack([0 * p, second - q, p, q, first - p], axis=-1)
    p, q = _rectangles(bracket - first * second, -first, second)
    starting_with_first = np.stack([first + p, q, -p, second - q, 0 * p], axis=-1)
    words = np.concatenate([starting_with_second, starting_with_first])
    return words[np.abs(words).sum(axis=-1).argmin(axis=0), np.arange(len(first))]


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
