"""Subdivide a path until the motion along it keeps its bounds: the critical step.

A walk swings out of its nominal path by the square root of a segment's length (the
strokes of a bracket of size h are sqrt(h) long). So a segment that leaves a bound by
`walking` although standing on its path would keep it by `standing` is cut into about
((standing - walking) / standing)^2 pieces. What grows with the length itself, as sweeps
along the heading do, takes that ratio to the power of 1. What is bounded is for others
to say.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from planner.errors import BoundError
from planner.numerics.arrays import Array

MOST_SEGMENTS = 1000  # a walk of an hour and more
MOST_PIECES = 3  # a segment is cut into at once: the law holds for short ones only


class Slack(NamedTuple):
    """What is left of a bound in each segment; negative where it is not kept."""

    bound: str  # its name
    least: float  # what it asks for
    standing: Array  # on the nominal path itself, shape (segments,), positive
    walking: Array  # least along the predicted motion, shape (segments,)
    law: float = 0.5  # power of a segment's length by which walking leaves standing
    unit: str = ""  # of what the user may ask for; none of what the path itself asks


def subdivide(cuts: Array, slacks: Callable[[Array], Sequence[Slack]]) -> Array:
    """Cut the segments of a path that leave a bound until none does.

    Args:
        cuts: Parameters that divide the path to begin with, from 0 to 1, ascending.
        slacks: Plans along a divided path and says what is left of each bound.

    Returns:
        Parameters that divide the path so that every slack is positive or zero.

    Raises:
        BoundError: More than `MOST_SEGMENTS` would be needed.
    """
    while True:
        found = slacks(cuts)
        pieces = np.max([needed(slack) for slack in found], axis=0)
        if (pieces == 1).all():
            return cuts
        if pieces.sum() > MOST_SEGMENTS:
            raise _refusal(cuts, found)
        cuts = refined(cuts, pieces)


def _refusal(cuts: Array, found: Sequence[Slack]) -> BoundError:
    worst = max(found, key=lambda slack: needed(slack).max())
    at = int(needed(worst).argmax())
    many = (
        f"more than {MOST_SEGMENTS} segments, above all between s = {cuts[at]:.4g} and "
        f"{cuts[at + 1]:.4g} of the path"
    )
    if not worst.unit:
        return BoundError(f"the {worst.bound} needs {many}; ask for a shorter path")
    kept = worst.least + worst.walking.min()
    return BoundError(
        f"{worst.bound} of {worst.least:.4g} {worst.unit} would need {many}; "
        f"{kept:.4g} {worst.unit} is kept with {len(cuts) - 1}: ask for less"
    )


def needed(slack: Slack) -> Array:
    """Pieces to cut each segment into, 1 where its bound is kept, shape (segments,)."""
    swing_out = slack.standing - slack.walking
    pieces = np.ceil((swing_out / slack.standing) ** (1 / slack.law))
    return np.where(slack.walking < 0, np.clip(pieces, 2, MOST_PIECES), 1).astype(int)


def refined(cuts: Array, pieces: Array) -> Array:
    """Each segment cut into equal pieces.

    Args:
        cuts: Shape (segments + 1,).
        pieces: How many of each segment, shape (segments,), at least 1.
    """
    parts = [
        np.linspace(a, b, n, endpoint=False)
        for a, b, n in zip(cuts[:-1], cuts[1:], pieces, strict=True)
    ]
    return np.append(np.concatenate(parts), cuts[-1])
