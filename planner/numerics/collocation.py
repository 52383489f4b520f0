"""Polynomials by their values at Chebyshev nodes: derivatives, integrals, flows.

Nodes include both ends of [0, 1]. They serve to differentiate paths, to integrate Hall
coordinates and to compute flows of vector fields, eq. (2), to machine precision.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from planner.errors import ConvergenceError, point
from planner.numerics.arrays import Array
from planner.support.stopping import tick

STEP_NODES = 24  # the tail of the Chebyshev series shows whether they suffice
PICARD_ITERATIONS = 40  # a triangular field needs as many as it has levels
PICARD_TOLERANCE = 1e-13  # relative, of the last change and of the series' tail
HALVINGS = 12  # of a step before the flow is refused


@dataclass(frozen=True, eq=False)
class Collocation:
    """Matrices that act on the values of a polynomial at nodes in [0, 1].

    Attributes:
        nodes: Chebyshev points of the second kind, ascending, shape (k,).
        derivative: Maps values to values of the derivative, shape (k, k).
        integral: Maps values to values of the integral from 0, shape (k, k).
        coefficients: Maps values to Chebyshev coefficients, shape (k, k).
    """

    nodes: Array
    derivative: Array
    integral: Array
    coefficients: Array


@cache
def collocation(size: int) -> Collocation:
    """Nodes and matrices for polynomials of degree below `size`, at least 2."""
    if size < 2:
        raise ValueError(f"collocation needs at least 2 nodes, got {size}")
    cosines = -np.cos(np.pi * np.arange(size) / (size - 1))
    to_coefficients = np.linalg.inv(chebyshev.chebvander(cosines, size - 1))
    derivative = (
        2 * chebyshev.chebvander(cosines, size - 2) @ chebyshev.chebder(to_coefficients)
    )
    primitive = chebyshev.chebint(to_coefficients, lbnd=-1) / 2
    integral = chebyshev.chebvander(cosines, size) @ primitive
    nodes = (cosines + 1) / 2
    nodes[0], nodes[-1] = 0.0, 1.0
    return Collocation(nodes, derivative, integral, to_coefficients)


def follow(
    field: Callable[[Array], Array],
    x: Array,
    duration: float,
    steady: Array | None = None,
) -> Array:
    """The end of a flow along a field, to machine precision, shape (n,).

    Picard's iteration on the nodes is exact after a few iterations if the rate of each
    coordinate depends on the coordinates before it only. For other fields it converges
    for short steps, so the duration is halved until it does.

    Args:
        field: Maps states of shape (k, n) to velocities of the same shape, which are
            not finite where the field is singular.
        x: Start, shape (n,).
        duration: Signed duration of the flow.
        steady: Velocity to begin the iteration with, such as the constant part of the
            field, shape (n,); none at all if not given.

    Raises:
        ConvergenceError: The flow escapes to infinity, or `HALVINGS` halvings do not
            suffice.
    """
    with np.errstate(all="ignore"):
        begin = np.zeros(np.shape(x)) if steady is None else steady
        end = _follow(field, np.asarray(x, dtype=float), duration, begin, HALVINGS)
    if end is None:
        raise ConvergenceError(
            f"flow for {duration:.6g} from {point(x)} does not converge; it "
            "escapes or is not smooth: make it shorter"
        )
    return end


def _follow(
    field: Callable[[Array], Array],
    x: Array,
    duration: float,
    steady: Array,
    halvings: int,
) -> Array | None:
    tick()
    end = _picard(field, x, duration, steady)
    if end is not None or halvings == 0:
        return end
    half = duration / 2, steady, halvings - 1
    middle = _follow(field, x, *half)
    return None if middle is None else _follow(field, middle, *half)


def _picard(
    field: Callable[[Array], Array], x: Array, duration: float, steady: Array
) -> Array | None:
    rule = collocation(STEP_NODES)
    path = x + duration * rule.nodes[:, None] * steady
    for _ in range(PICARD_ITERATIONS):
        before, velocity = path, field(path)
        path = x + duration * (rule.integral @ velocity)
        scale = 1.0 + np.abs(path).max()
        if not scale < np.inf:
            return None
        if np.abs(path - before).max() <= PICARD_TOLERANCE * scale:
            tail = np.abs(rule.coefficients[-2:] @ velocity).max() * abs(duration)
            return path[-1] if tail <= 10 * PICARD_TOLERANCE * scale else None
    return None
