"""Mirrored words: the same Hall coordinates, the leading error with the other sign.

A word that is exact to degree k misses brackets of degree k + 1. Two symmetries of the
free Lie algebra turn one exact word into another one:

    the automorphism g -> -g           maps an element B of degree d to (-1)^d B,
    reversal in time, g -> g           maps it to (-1)^(d + 1) B.

Where every bracket to be approximated is of even degree the first keeps it, where it is
of odd degree the second does; what is kept and what is missed have opposite signs if k
is of the bracket's parity. A word and its mirror image in turn then miss one degree
less, at no cost: the flows are as many.
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

    Args:
        basis: Hall elements, s of them.
        hall_coordinates: Backward coordinates, shape (segments, s).
        bracket_degree: Degree of the brackets that the words approximate; its parity
            chooses the symmetry.
        vanishing: As in `lie.input_words.word`.
    """
    signs = (-1.0) ** np.array(lie_algebra(tuple(basis)).degrees)
    if bracket_degree % 2 == 0:
        words = spellings(basis, hall_coordinates * signs, "backward", vanishing)
        return [(letters, [-t for t in times]) for letters, times in words]
    turned = backward_from_forward(basis, -signs * hall_coordinates)
    words = spellings(basis, turned, "backward", vanishing)
    return [(letters[::-1], times[::-1]) for letters, times in words]
