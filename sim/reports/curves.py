"""Curves reduced to few points without a visible change."""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.motion.polylines import spaced_rows

BINS = 500  # of a time axis; each keeps its extremes
SPACING = 1 / 600  # of a path's extent, between its points


def extremes(values: Array, bins: int = BINS) -> Array:
    """Rows that keep the least and the greatest value of every bin, ascending.

    Args:
        values: Shape (T,) or (T, k).
        bins: Into which the rows are divided evenly.
    """
    count = len(values)
    if count <= 2 * bins:
        return np.arange(count)
    columns = values.reshape(count, -1)
    edges = np.linspace(0, count, bins + 1).astype(int)
    kept = [np.array([0, count - 1])]
    for start, stop in zip(edges[:-1], edges[1:], strict=True):
        part = columns[start:stop]
        kept += [start + part.argmin(axis=0), start + part.argmax(axis=0)]
    return np.unique(np.concatenate(kept))


def along(points: Array) -> Array:
    """Rows of a path about evenly apart, the last one among them.

    Args:
        points: Shape (T, 2).
    """
    extent = float(np.ptp(points, axis=0).max()) or 1.0
    rows = spaced_rows(points, SPACING * extent)
    return np.unique(np.append(rows, len(points) - 1))


def round_factor(largest: float) -> float:
    """The greatest of 1, 2, 5, 10, 20, ... that is not above a number, at least 1."""
    if not largest >= 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(largest))
    return float(max(digit * power for digit in (1, 2, 5) if digit * power <= largest))
