"""Subdivide a path until the motion along it keeps its bounds (Sec. 5.2).

The strokes of a bracket of size h have length sqrt(h), so a motion departs from its
nominal path by about the square root of the length of a segment, or the length itself
along the heading. With a slack `standing` on the path itself and `walking` along the
motion, a segment is therefore cut into about ((standing - walking) / standing)^2 pieces
or without the square. Callers decide what is bounded.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from planner.errors import BoundError, message
from planner.numerics.arrays import Array
from planner.support.stopping import tick

MOST_DIVIDED = 1000  # more than an hour of walking
MOST_PIECES = 3  # of a segment at once, since the law holds for short segments only


class Slack(NamedTuple):
    """The slack of a bound in each segment; negative where the bound is not kept."""

    bound: str  # name of the bounded quantity
    least: float  # the bound, its least value
    standing: Array  # slack on the nominal path itself, shape (segments,), positive
    walking: Array  # least slack along the predicted motion, shape (segments,)
    law: float = 0.5  # power of a segment's length with which the departure grows
    unit: str = ""  # of a bound that the user has set; empty for one due to the path

    @property
    def kept(self) -> float:
        """The value that the motion keeps."""
        return float(self.least + self.walking.min())


def subdivide(cuts: Array, slacks: Callable[[Array], Sequence[Slack]]) -> Array:
    """Cut the segments that do not keep a bound, until all segments keep all bounds.

    The cuts are parameters from 0 to 1, ascending, at first and as returned; `slacks`
    plans along a path with these cuts, and gives the slack of each bound.

    Raises:
        BoundError: More than `MOST_DIVIDED` segments would be needed.

    Example:
        >>> import numpy as np
        >>> from planner import subdivide
        >>> from planner.planning import Slack
        >>> def slacks(cuts):
        ...     lengths = np.diff(cuts)
        ...     return [Slack("length", 0.0, np.full(len(lengths), 0.4), 0.4 - lengths)]
        >>> subdivide(np.array([0.0, 1.0]), slacks).round(2)
        array([0.  , 0.33, 0.67, 1.  ])
    """
    while True:
        found = slacks(cuts)
        pieces = np.max([needed(slack) for slack in found], axis=0)
        if (pieces == 1).all():
            return cuts
        kept = [f"{s.bound} of {s.kept:.4g} {s.unit}" for s in found if s.unit]
        held = f", which keep {' and '.join(kept)}" if kept else ""
        tick(f"{len(cuts) - 1} segments{held}")
        if pieces.sum() > MOST_DIVIDED:
            raise _refusal(cuts, found)
        cuts = refined(cuts, pieces)


def _refusal(cuts: Array, found: Sequence[Slack]) -> BoundError:
    worst = max(found, key=lambda slack: needed(slack).max())
    at = int(needed(worst).argmax())
    many = message("many", most=MOST_DIVIDED, low=cuts[at], high=cuts[at + 1])
    if not worst.unit:
        return BoundError(f"the {worst.bound} needs {many}; give a shorter path")
    return BoundError(message("finer", of=worst, many=many, count=len(cuts) - 1))


def needed(slack: Slack) -> Array:
    """Number of pieces for each segment, 1 where the bound is kept, (segments,)."""
    departure = slack.standing - slack.walking
    pieces = np.ceil((departure / slack.standing) ** (1 / slack.law))
    return np.where(slack.walking < 0, np.clip(pieces, 2, MOST_PIECES), 1).astype(int)


def refined(cuts: Array, pieces: Array) -> Array:
    """Parameters (segments + 1,) after each segment is cut into equal pieces."""
    parts = [
        np.linspace(a, b, n, endpoint=False)
        for (a, b), n in zip(pairwise(cuts), pieces, strict=True)
    ]
    return np.append(np.concatenate(parts), cuts[-1])
