"""Flows of coordinates that drive themselves as angles do.

The heading of a trailer follows theta' = c + a cos theta + b sin theta, where c, a and
b depend on the car alone. Half the angle is then the direction of a point (u, v) of a
linear system, u' = -b/2 u + (a - c)/2 v and v' = (a + c)/2 u + b/2 v. Its matrices are
found for all flows at once, before it is known where each of them starts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, hypot, pi, sin

import numpy as np
import sympy as sp

from planner.numerics.arrays import Array
from planner.numerics.collocation import ITERATIONS, TOLERANCE, Collocation
from planner.systems.fields import Symbols
from planner.systems.rounding import vanishing


def is_angular(rates: Sequence[sp.Expr], angle: sp.Symbol, state: Symbols) -> bool:
    """Whether all rates of a coordinate are of the form c + a cos + b sin of it.

    Args:
        rates: Rates of the coordinate along some fields.
        angle: Symbol of the coordinate.
        state: Symbols of the state.
    """
    return all(
        vanishing([sp.Matrix([r.diff(angle, 3) + r.diff(angle)])], state)[0]
        for r in rates
    )


def angular_ways(
    rate: Callable[[float], Array], start: float, durations: Array, rule: Collocation
) -> Array | None:
    """How far a coordinate has come at each node of each of a sequence of flows.

    Args:
        rate: Rates at the nodes of all flows wherever the coordinate has a given value,
            shape (nodes, flows).
        start: Value of the coordinate before the first flow.
        durations: Signed durations of the flows, shape (flows,).
        rule: Nodes in each flow.

    Returns:
        Shape (nodes, flows); None if a flow is too long for the nodes.
    """
    ahead, aside, back = (durations * rate(angle) for angle in (0.0, pi / 2, pi))
    moved = np.flatnonzero(ahead.any(axis=0) | aside.any(axis=0) | back.any(axis=0))
    ahead, aside, back = ahead[:, moved], aside[:, moved], back[:, moved]
    mean, along = (ahead + back) / 2, (ahead - back) / 2
    across = aside - mean
    if not _largest(np.abs(mean) + np.abs(along) + np.abs(across)) < pi:
        return None
    points = _points(across / 2, (along - mean) / 2, (along + mean) / 2, rule)
    if points is None:
        return None
    u, v = points
    x, y = _starts(u[:, -1], v[:, -1], start / 2)
    u, v = u[0] * x + u[1] * y, v[0] * x + v[1] * y
    ways = np.zeros((len(rule.nodes), durations.size))
    ways[:, moved] = 2 * np.arctan2(x * v - y * u, x * u + y * v)
    return ways


def _starts(u: Array, v: Array, angle: float) -> Array:
    """Directions in which flows begin one after another, shape (2, flows).

    Args:
        u: Upper row of each flow's matrix, shape (2, flows).
        v: Lower row of it, same shape.
        angle: Direction before the first flow.
    """
    x, y = cos(angle), sin(angle)
    starts = []
    for u_x, u_y, v_x, v_y in np.concatenate([u, v]).T.tolist():
        starts.append((x, y))
        x, y = u_x * x + u_y * y, v_x * x + v_y * y
        size = hypot(x, y)
        x, y = x / size, y / size
    return np.array(starts).reshape(-1, 2).T


def _points(
    diagonal: Array, upper: Array, lower: Array, rule: Collocation
) -> tuple[Array, Array] | None:
    """Both coordinates of the points that start at (1, 0) and at (0, 1).

    Args:
        diagonal: Lower right entry of the linear system, shape (nodes, flows); the
            upper left one is its negative.
        upper: Upper right entry, same shape.
        lower: Lower left entry, same shape.
        rule: Nodes in each flow.

    Returns:
        Shape (2, nodes, flows) each; None if the nodes do not suffice.
    """
    begin = np.eye(2)[:, :, None, None]
    u, v = np.broadcast_to(begin, (2, 2, *diagonal.shape))
    for _ in range(ITERATIONS):
        before = u, v
        rates = upper * v - diagonal * u, lower * u + diagonal * v
        u, v = (b + rule.integral @ r for b, r in zip(begin, rates, strict=True))
        if max(_largest(u - before[0]), _largest(v - before[1])) <= TOLERANCE:
            tail = max(_largest(rule.coefficients[-2:] @ r) for r in rates)
            return (u, v) if tail <= TOLERANCE else None
    return None


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
