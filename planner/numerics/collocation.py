"""Polynomials by their values at Chebyshev nodes: derivatives, integrals, flows.

Nodes include both ends of [0, 1]. They serve to differentiate paths, to integrate Hall
coordinates and to compute flows of vector fields, eq. (2), to machine precision.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from planner.errors import ConvergenceError, message, point
from planner.numerics.arrays import Array
from planner.support.stopping import tick

STEP_NODES = 24  # the tail of the Chebyshev series shows whether they suffice
PICARD_ITERATIONS = 40  # a triangular field needs as many as it has levels
PICARD_TOLERANCE = 1e-13  # relative, of the last change and of the series' tail
HALVINGS = 12  # of a step before the flow is refused
TRIALS = (7, 11, 15)  # iterations after which tails show whether nodes may suffice
HOPELESS = 1e3  # times the tolerated tail


@dataclass(frozen=True, eq=False)
class Collocation:
    """Matrices (k, k) that act on the values of a polynomial at nodes in [0, 1]."""

    nodes: Array  # Chebyshev points of the second kind, ascending, shape (k,)
    derivative: Array  # to values of the derivative
    integral: Array  # to values of the integral from 0
    coefficients: Array  # to Chebyshev coefficients


@cache
def collocation(size: int) -> Collocation:
    """Nodes and matrices for polynomials of degree below `size`, at least 2."""
    if size < 2:
        raise ValueError(f"collocation needs at least 2 nodes, got {size}")
    cosines = -np.cos(np.pi * np.arange(size) / (size - 1))
    to_coefficients = np.linalg.inv(chebyshev.chebvander(cosines, size - 1))
    slopes = chebyshev.chebder(to_coefficients)
    derivative = 2 * chebyshev.chebvander(cosines, size - 2) @ slopes
    primitive = chebyshev.chebint(to_coefficients, lbnd=-1) / 2
    integral = chebyshev.chebvander(cosines, size) @ primitive
    nodes = (cosines + 1) / 2
    nodes[0], nodes[-1] = 0.0, 1.0
    return Collocation(nodes, derivative, integral, to_coefficients)


def follow(field: Callable[[Array], Array], x: Array, duration: float) -> Array:
    """The end of a flow along a field from x of shape (n,), to machine precision.

    Picard's iteration on the nodes is exact after a few iterations if the rate of each
    coordinate depends on the coordinates before it only. For other fields it converges
    for short steps, so the duration is halved until it does; a flow that `HALVINGS` do
    not suffice for, or that escapes, raises `ConvergenceError`. The field maps states
    (k, n) to velocities, not finite where it is singular.
    """
    starts, durations = np.asarray(x, dtype=float)[None], np.array([duration])
    (end,) = follow_all(field, starts, durations)
    if not np.isfinite(end).all():
        raise ConvergenceError(message("escapes", duration=duration, start=point(x)))
    return end


def follow_all(
    field: Callable[[Array], Array], x: Array, durations: Array, nodes: int = STEP_NODES
) -> Array:
    """Ends of flows along one field from several states, shape (flows, n).

    They are nan where a flow does not converge; otherwise as `follow`.
    """
    with np.errstate(all="ignore"):
        return _follow(field, x, durations, collocation(nodes), HALVINGS)


def _follow(
    field: Callable[[Array], Array],
    x: Array,
    durations: Array,
    rule: Collocation,
    halvings: int,
) -> Array:
    tick()
    ends = _picard(field, x, durations, rule)
    (left,) = np.nonzero(np.isnan(ends[:, 0]) & np.isfinite(x).all(axis=1))
    if len(left) and halvings:
        half = durations[left] / 2, rule, halvings - 1
        ends[left] = _follow(field, _follow(field, x[left], *half), *half)
    return ends


def _picard(
    field: Callable[[Array], Array], x: Array, durations: Array, rule: Collocation
) -> Array:
    """Ends of the flows for which the iteration converges, nan for others.

    It begins with the velocity at the start, and gives up where rates that are nearly
    found need more nodes.
    """
    by = durations[:, None]
    path = x + by * rule.nodes[:, None, None] * field(x)  # (nodes, flows, n)
    ends, going = np.full(x.shape, np.nan), np.arange(len(x))
    for iteration in range(PICARD_ITERATIONS):
        before, (nodes, flows, size) = path, path.shape
        rates = field(path.reshape(-1, size)).reshape(nodes, -1)
        path = x + by * (rule.integral @ rates).reshape(path.shape)
        scale = 1.0 + _largest(path)
        met = _largest(path - before) <= PICARD_TOLERANCE * scale
        kept = ~met & (scale < np.inf)
        if met.any() or iteration in TRIALS:
            last = (rule.coefficients[-2:] @ rates).reshape(2, flows, size)
            tails = _largest(last) * np.abs(by[:, 0]) / (10 * PICARD_TOLERANCE * scale)
            good = met & (tails <= 1.0)
            ends[going[good]] = path[-1, good]
            kept &= tails <= HOPELESS
        if not kept.any():
            break
        if not kept.all():
            going, x, by, path = going[kept], x[kept], by[kept], path[:, kept]
    return ends


def _largest(values: Array) -> Array:
    """Largest absolute value for each flow, of values (nodes, flows, n)."""
    return np.abs(values).max(axis=0).max(axis=1)  # faster than both at once
