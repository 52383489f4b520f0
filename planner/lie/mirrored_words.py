"""Mirrored words reach the same Hall coordinates with the opposite leading error.

A word that is exact to degree k misses its goal by brackets of degree k + 1. Two
symmetries of the free Lie algebra turn one exact word into another:

    changing the sign of all generators    multiplies an element of degree d by (-1)^d,
    reversing the order of the flows       multiplies it by (-1)^(d + 1).

If every bracket that a word approximates is of even degree, the first symmetry leaves
these brackets unchanged; if every one is of odd degree, the second does. If k has the
same parity as these brackets, the same symmetry changes the sign of the error, whose
degree is k + 1. A word followed by its mirror image therefore cancels the errors of
degree k + 1, and needs no more flows than the same word twice.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from planner.lie.coordinates import backward_from_forward
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import Element
from planner.lie.input_words import Spelling, spellings
from planner.numerics.arrays import Array


def mirrored_spellings(
    basis: Sequence[Element],
    hall_coordinates: Array,
    bracket_degree: int,
    vanishing: Collection[Element] = (),
) -> list[Spelling]:
    """Mirror images of backward words, which realise the same Hall coordinates.

    These are backward ones (segments, s). The degree of the brackets that the words
    approximate chooses the symmetry; `vanishing` is as in `lie.input_words.word`.
    """
    signs = (-1.0) ** np.array(lie_algebra(tuple(basis)).degrees)
    if bracket_degree % 2 == 0:
        words = spellings(basis, hall_coordinates * signs, "backward", vanishing)
        return [(letters, [-t for t in times]) for letters, times in words]
    turned = backward_from_forward(basis, -signs * hall_coordinates)
    words = spellings(basis, turned, "backward", vanishing)
    return [(letters[::-1], times[::-1]) for letters, times in words]
