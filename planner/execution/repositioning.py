"""Leg repositioning: legs move through the air one at a time, with static stability.

Whether the robot is statically stable without a leg depends on where the other legs
are. A leg may therefore have to wait for another one, or another leg may have to stand
elsewhere for a while. The cheapest sequence of moves between given places of the legs
is found by value iteration over all combinations of places.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.numerics.arrays import Array

LIFT = 1.0  # cost of lifting a leg, in the unit of distances between places


def reposition_legs(
    places: Sequence[Array],
    steady: Array,
    now: Sequence[int],
    goal: Sequence[int],
) -> list[tuple[int, float]] | None:
    """The cheapest sequence of moves, one leg at a time.

    Args:
        places: Places where each of L legs may stand, shape (P_i,).
        steady: Whether the robot is stable while a leg is in the air, for each leg and
            all combinations of places, shape (L, P_1, ..., P_L), bool.
        now: Index of the place where each leg is.
        goal: Index of the place where each leg is to be.

    Returns:
        Leg and place of each move in time order; None if no sequence leads there.
    """
    ways = [_ways(place) for place in places]
    cost = np.full([len(place) for place in places], np.inf)
    cost[tuple(goal)] = 0.0
    nearer = _nearer(cost, ways, steady)
    while (nearer < cost).any():
        cost, nearer = nearer, _nearer(nearer, ways, steady)
    here, moves = list(now), list[tuple[int, float]]()
    if not np.isfinite(cost[tuple(here)]):
        return None
    while here != list(goal):
        leg, place = _next(cost, ways, steady, here)
        here[leg] = place
        moves.append((leg, float(places[leg][place])))
    return moves


def _ways(place: Array) -> Array:
    """Cost of a move between two places of a leg, shape (P, P); infinite to stay."""
    way = LIFT + np.abs(place[:, None] - place)
    np.fill_diagonal(way, np.inf)
    return way


def _nearer(cost: Array, ways: Sequence[Array], steady: Array) -> Array:
    """Cost of reaching the goal with at most one more move than before."""
    best = cost
    for leg, (way, free) in enumerate(zip(ways, steady, strict=True)):
        landed = np.where(free, cost, np.inf).swapaxes(leg, 0)  # (P, ...)
        across = way.reshape(*way.shape, *[1] * (cost.ndim - 1)) + landed
        onward = across.min(axis=1).swapaxes(leg, 0)
        best = np.minimum(best, np.where(free, onward, np.inf))
    return best


def _next(
    cost: Array, ways: Sequence[Array], steady: Array, here: Sequence[int]
) -> tuple[int, int]:
    """Leg and place of the next move of a cheapest sequence."""
    best = (np.inf, 0, 0)
    for leg, (way, free) in enumerate(zip(ways, steady, strict=True)):
        if free[tuple(here)]:
            landed = np.where(free, cost, np.inf)
            line = np.moveaxis(landed, leg, -1)[(*here[:leg], *here[leg + 1 :])]
            onward = way[here[leg]] + line
            place = int(np.argmin(onward))
            best = min(best, (float(onward[place]), leg, place))
    return best[1], best[2]
