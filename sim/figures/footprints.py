"""Footprints: where each foot stood, for how long, and how far it slid there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner import Array


@dataclass(frozen=True)
class Footprints:
    """Stays of feet on the ground, in time order for each foot."""

    foot: Array  # index of the foot, (K,)
    begin: Array  # first row of the stay, (K,)
    end: Array  # last row, (K,)
    place: Array  # of the foot in the middle of the stay, (K, 2)
    slid: Array  # distance from its first place to its last, (K,)


def footprints(points: Array, contact: Array) -> Footprints:
    """Stays of all feet.

    Args:
        points: Where each foot is, shape (T, F, 2).
        contact: Whether it is on the ground, shape (T, F), bool.
    """
    padded = np.pad(contact.T.astype(np.int8), ((0, 0), (1, 1)))  # (F, T + 2)
    change = np.diff(padded, axis=1)
    foot, begin = np.nonzero(change > 0)
    _, end = np.nonzero(change < 0)
    end = end - 1
    slid = points[end, foot] - points[begin, foot]
    return Footprints(
        foot=foot,
        begin=begin,
        end=end,
        place=points[(begin + end) // 2, foot],
        slid=np.hypot(*slid.T),
    )
