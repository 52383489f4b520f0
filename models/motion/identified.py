"""Identified body twists: polynomials fitted to measurements of each loaded field.

Each field was measured along its own swing. The experiments are in `sim.experiments`;
their results are stored and evaluated here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial import Polynomial

from models.errors import MeasurementError
from planner import Array

ROUNDING = 1e-6  # [rad] by which angles may lie beyond the reach


@dataclass(frozen=True)
class MeasuredField:
    """One field of one stratum, measured from one end of its swing to the other."""

    stratum: str
    direction: tuple[float, ...]  # what one unit of it does to the groups' angles
    span: float  # the swing went from -span to span [rad]
    twist: tuple[Polynomial, Polynomial, Polynomial]  # per unit, along the swing
    slip: float  # of all feet, during the whole swing [m]
    reach: float = np.inf  # a stroke it was not made from confirms it so far [rad]

    def __call__(self, way: Array) -> Array:
        """Body twist per unit of the field, shape (..., 3).

        Args:
            way: Position of the groups' angles along the swing; beyond the span the
                twist is that of its end.
        """
        inside = np.clip(way, -self.span, self.span)
        return np.stack([part(inside) for part in self.twist], axis=-1)


@dataclass(frozen=True, slots=True)
class FailedField:
    """One field of one stratum that could not be measured."""

    stratum: str
    reason: str  # in words


@dataclass(frozen=True)
class IdentifiedTwists:
    """Measured fields added up; the angles of other groups are taken not to matter."""

    fields: Mapping[str, MeasuredField]
    failed: Mapping[str, FailedField] = field(default_factory=dict)

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """The fields of the stratum that together have these rates.

        Raises:
            MeasurementError: If one of them could not be measured, or swings farther
                than it was confirmed.
        """
        for name, failed in self.failed.items():
            if failed.stratum == stratum:
                raise MeasurementError(
                    f"field {name} could not be measured: {failed.reason}; "
                    "choose groups that it can stand on"
                )
        named = {n: f for n, f in self.fields.items() if f.stratum == stratum}
        on = list(named.values())
        D = np.array([f.direction for f in on])  # (fields, G)
        inverse = np.linalg.pinv(D)
        inputs, ways = rates @ inverse, swing @ inverse  # (N, fields)
        for name, f, u, w in zip(named, on, inputs.T, ways.T, strict=True):
            farthest = np.abs(w[u != 0.0]).max(initial=0.0)
            if farthest > f.reach + ROUNDING:
                raise MeasurementError(
                    f"field {name} swings to {farthest:.3g} rad, and is confirmed to "
                    f"{f.reach:.3g} rad either way; plan more segments"
                )
        parts = [
            u[:, None] * f(w) for f, u, w in zip(on, inputs.T, ways.T, strict=True)
        ]
        return np.sum(parts, axis=0)
