"""Lines through points on the floor: their length, and points about evenly apart."""

from __future__ import annotations

import numpy as np

from planner import Array


def length_up_to(points: Array) -> Array:
    """Length of a line from its first point to each, shape (N,).

    Args:
        points: Shape (N, 2).
    """
    steps = np.diff(points, axis=0, prepend=points[:1])
    return np.cumsum(np.hypot(*steps.T))


def spaced_rows(points: Array, spacing: float) -> Array:
    """Rows of the first point, and of the next ones about a length farther on.

    Args:
        points: Shape (N, 2).
        spacing: The length.
    """
    marks = np.floor(length_up_to(points) / spacing)
    return np.unique(marks, return_index=True)[1]
