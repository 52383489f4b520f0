"""Body twists as measured: each loaded field along its own swing, as polynomials.

Holds and evaluates what experiments found; the experiments are `sim.identify`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

Array = np.ndarray


@dataclass(frozen=True)
class MeasuredField:
    """One field of one stratum, measured from one end of its swing to the other."""

    stratum: str
    direction: tuple[float, ...]  # what one unit of it does to the groups' angles
    span: float  # it was swung from -span to span [rad]
    twist: tuple[Polynomial, Polynomial, Polynomial]  # of the unit, by how far it is
    slip: float  # of all feet, during the whole swing [m]

    def __call__(self, way: Array) -> Array:
        """Body twist per unit of the field, shape (..., 3).

        Args:
            way: How far along it the groups' angles are; beyond the span the twist is
                that of its end.
        """
        inside = np.clip(way, -self.span, self.span)
        return np.stack([part(inside) for part in self.twist], axis=-1)


@dataclass(frozen=True)
class IdentifiedTwists:
    """Measured fields added up; the angles of other groups are taken not to matter."""

    fields: Mapping[str, MeasuredField]

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """The fields of the stratum that together have these rates."""
        on = [field for field in self.fields.values() if field.stratum == stratum]
        D = np.array([field.direction for field in on])  # (fields, G)
        inverse = np.linalg.pinv(D)
        inputs, ways = rates @ inverse, swing @ inverse  # (N, fields)
        parts = [
            u[:, None] * f(w) for f, u, w in zip(on, inputs.T, ways.T, strict=True)
        ]
        return np.asarray(np.sum(parts, axis=0))
