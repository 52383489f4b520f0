"""Integrals of functions known at a few nodes of many panels, all at once.

A panel is an interval of a common clock; inside it the integrand is the polynomial
through its values at the Gauss-Legendre nodes, so that an
integral over whole panels has the precision of Gaussian quadrature, and one up to any
moment is a polynomial.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from planner import Array

NODES = 4  # exact for integrands of degree 7 over a panel
_POINTS, _WEIGHTS = legendre.leggauss(NODES)


def _integrals(u: Array) -> Array:
    """Integrals from 0 to u of the shifted Legendre polynomials, shape (..., NODES)."""
    P = legendre.legvander(2 * u - 1, NODES)  # (..., NODES + 1)
    k = np.arange(1, NODES)
    higher = (P[..., 2:] - P[..., :-2]) / (2 * (2 * k + 1))
    return np.concatenate([u[..., None], higher], axis=-1)


# Values at the nodes -> Legendre coefficients -> integrals from the panel's start.
_COEFFICIENTS = np.linalg.inv(legendre.legvander(_POINTS, NODES - 1))
FRACTIONS = (_POINTS + 1) / 2  # where the nodes lie in a panel
_TO_NODES = _integrals(FRACTIONS) @ _COEFFICIENTS  # (NODES, NODES)


@dataclass(frozen=True)
class Integral:
    """The integral of a vector function from the start of the first panel."""

    edges: Array  # ends of the panels on the clock, increasing, shape (P + 1,)
    values: Array  # integrand by the panel's own clock (0 to 1), shape (P, NODES, C)

    def __call__(self, clock: Array) -> Array:
        """The integral up to given moments.

        Args:
            clock: Moments, shape (M,); those beyond the ends count as the ends.

        Returns:
            Shape (M, C).
        """
        if len(self.values) == 0:
            return np.zeros((len(clock), self.values.shape[-1]))
        panel = np.searchsorted(self.edges, clock, side="right") - 1
        panel = np.clip(panel, 0, len(self.values) - 1)
        begin, end = self.edges[panel], self.edges[panel + 1]
        u = np.clip((clock - begin) / (end - begin), 0.0, 1.0)
        weights = _integrals(u) @ _COEFFICIENTS  # (M, NODES)
        inside = np.einsum("mn,mnc->mc", weights, self.values[panel])
        return self._starts[panel] + inside

    def at_nodes(self) -> Array:
        """The integral at every node, shape (P, NODES, C)."""
        inside = np.einsum("jn,pnc->pjc", _TO_NODES, self.values)
        return self._starts[:-1, None] + inside

    @property
    def total(self) -> Array:
        """The integral over all panels, shape (C,)."""
        return self._starts[-1]

    @cached_property
    def _starts(self) -> Array:
        """The integral at every edge, shape (P + 1, C)."""
        whole = np.einsum("n,pnc->pc", _WEIGHTS / 2, self.values)
        begin = np.zeros((1, whole.shape[1]))
        return np.concatenate([begin, np.cumsum(whole, axis=0)])
