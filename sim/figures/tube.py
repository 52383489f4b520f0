"""The tube: the deviation of a walk from its nominal path within its segments.

A bracket of size h needs strokes of size sqrt(h) (eq. 20), so the tube's width falls as
the square root of the segments' length and not as the length itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from planner import Array, line
from sim.figures.paper import SAMPLES, PaperWalk, configuration, walk


@dataclass(frozen=True)
class Tube:
    """How a straight line is followed, by the number of its segments."""

    way: float  # length of the line
    segments: Array  # ascending, (K,)
    width: Array  # largest distance from the line, (K,)
    turn: Array  # largest departure from the line's heading, (K,) [rad]
    error: Array  # distance of the end from the goal, (K,)

    @property
    def length(self) -> Array:
        """Of one segment, (K,)."""
        return self.way / self.segments

    @property
    def exponent(self) -> float:
        """Power of the length by which the width grows, over the finer half."""
        fine = self.segments >= np.median(self.segments)
        return exponent(self.length[fine], self.width[fine])

    @property
    def last_exponent(self) -> float:
        """The same between the two finest divisions."""
        return exponent(self.length[-2:], self.width[-2:])


def follow(goal: Sequence[float], segments: int, samples: int = SAMPLES) -> PaperWalk:
    """Walk straight to a goal at constant heading on the paper's kinematics."""
    path = line(configuration((0, 0, 0)), configuration(goal))
    return walk(path, segments, samples=samples)


def tube(goal: Sequence[float], segments: Sequence[int]) -> Tube:
    """Walk the line in different numbers of segments."""
    walks = [follow(goal, n, samples=2) for n in segments]
    # produced beyond its ends: going past the goal is not leaving the line
    produced = np.outer([-1.0, 2.0], goal[:2])
    widths = [swing_out(w.states[:, :2], w.ends, produced).max() for w in walks]
    return Tube(
        way=float(np.linalg.norm(goal[:2])),
        segments=np.array(segments),
        width=np.array(widths),
        turn=np.array([np.abs(w.states[:, 2]).max() for w in walks]),
        error=np.array([w.error for w in walks]),
    )


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


def envelope(points: Array, ends: Array, start: Array, goal: Array) -> Array:
    """The farthest points of each segment to the right and to the left of a line.

    Args:
        points: Positions walked through, shape (N, 2).
        ends: Index of the point that closes each segment, ascending, shape (segments,).
        start: A point of the line, shape (2,).
        goal: Another one ahead of it, shape (2,).

    Returns:
        Shape (2, segments, 2): points to the right, then points to the left.
    """
    along = np.asarray(goal, dtype=float) - start
    left = (points - start) @ np.array([-along[1], along[0]])
    starts = np.concatenate([[0], ends[:-1]])
    spans = [slice(a, b + 1) for a, b in zip(starts, ends, strict=True)]
    extremes = [
        [span.start + choose(left[span]) for span in spans]
        for choose in (np.argmin, np.argmax)
    ]
    return points[np.array(extremes)]


def exponent(lengths: Array, widths: Array) -> float:
    """Power by which widths grow with lengths: the slope through their logarithms."""
    return float(np.polyfit(np.log(lengths), np.log(widths), 1)[0])
