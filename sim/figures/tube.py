"""The tube: how far a walk swings out of its nominal path within its segments.

A bracket of size h needs strokes of size sqrt(h) (eq. 20), so the tube's width falls as
the square root of the segments' length and not as the length itself.
"""

from __future__ import annotations

import numpy as np
import shapely

Array = np.ndarray


def swing_out(points: Array, ends: Array, nominal: Array) -> Array:
    """Largest distance from the nominal curve within each segment.

    Args:
        points: Positions walked through, shape (N, 2).
        ends: Index of the point that closes each segment, ascending, shape (segments,).
        nominal: The curve as a fine chain, shape (M, 2).

    Returns:
        Shape (segments,), in the unit of the points.
    """
    distance = shapely.distance(shapely.points(points), shapely.LineString(nominal))
    starts = np.concatenate([[0], ends[:-1]])
    return np.array(
        [distance[a : b + 1].max() for a, b in zip(starts, ends, strict=True)]
    )


def exponent(lengths: Array, widths: Array) -> float:
    """Power by which widths grow with lengths: the slope through their logarithms."""
    return float(np.polyfit(np.log(lengths), np.log(widths), 1)[0])
