"""A lower bound on the time of a walk, however it is planned.

A walk that passes the points of its path in order, each within a tolerance, is at least
as long as the way through circles around them. The body is nowhere faster than the
fastest stroke moves it, with all joints at full speed. Lifts, accelerations and the
strokes that turn the body only add to that.
"""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.optimisation.judging import real_twists
from sim.preparation.setup import Setup

ANGLES = 25  # of each group, ends of the joint range included
SAMPLES = 4000  # of angles where there are too many groups for a grid
GRID = 2  # groups at most
POINTS = 101  # of the path


def least_time(setup: Setup, within: float) -> float:
    """Time that the strokes of any walk along the path take at least [s].

    Args:
        setup: Robot, path and speeds.
        within: How far the body may stray from the path [m].
    """
    points = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, POINTS))
    return shortest_way(points[:, :2], within) / top_speed(setup)


def top_speed(setup: Setup) -> float:
    """Largest speed that a stroke of a plan gives the body [m/s]."""
    described, twists = setup.equations, real_twists(setup)
    low, high = np.array(list(described.limits.values())).T
    if len(low) <= GRID:
        shares = np.stack(np.meshgrid(*[np.linspace(0, 1, ANGLES)] * len(low)), axis=-1)
        shares = shares.reshape(-1, len(low))
    else:
        shares = np.random.default_rng(0).uniform(size=(SAMPLES, len(low)))
    swing, fastest = low + shares * (high - low), 0.0
    for name in set(described.elements) & set(described.swings):
        direction = np.array(described.swings[name])
        rates = direction / np.abs(direction).max() * setup.limits.swing_speed
        stratum = described.system.stratum_of[name]
        velocity = twists(stratum, swing, np.broadcast_to(rates, swing.shape))
        fastest = max(fastest, float(np.hypot(*velocity[:, :2].T).max()))
    return fastest


def shortest_way(points: Array, within: float) -> float:
    """A lower bound on a way through circles around points, in their order.

    The way begins at the first point and ends at the last one. Some of the points are
    left out, so that the sum of what lies between the circles of the others is largest.

    Args:
        points: Shape (K, 2) [m].
        within: Radius of the circles [m].
    """
    radii = np.full(len(points), within)
    radii[[0, -1]] = 0.0
    longest = np.zeros(len(points))
    for k in range(1, len(points)):
        apart = np.linalg.norm(points[:k] - points[k], axis=1) - radii[:k] - radii[k]
        longest[k] = (longest[:k] + apart).max()
    return max(float(longest[-1]), 0.0)
