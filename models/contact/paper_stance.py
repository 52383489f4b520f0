"""The paper's stance on three legs and its static stability: Fig. 5, Sec. 6.

Six legs of one length are attached at the front, in the middle and at the rear of the
body and stand square to it at angle 0; a positive angle sweeps every foot backward. In
the closed forms the weight lies on the body's long axis, a distance b behind the front.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from planner import Array

_ROWS = np.array([0.5, 0.0, -0.5])  # front, middle, rear [body lengths]
_SIDES = {1: np.array([1.0, -1.0, 1.0]), 2: np.array([-1.0, 1.0, -1.0])}


@dataclass(frozen=True)
class PaperStance:
    """Lengths of the paper's hexapod, in any one unit.

    Attributes:
        body_length: From the front legs' hips to the rear ones', l_b.
        leg_length: From hip to foot, l.
        half_width: Of the body, at which the hips sit.

    Raises:
        ValueError: A length is not positive.

    Example:
        >>> from models import PaperStance
        >>> low, high = PaperStance(3.0, leg_length=1.0, half_width=0.5).bounds(0.0)
        >>> float(low), float(high)
        (0.75, 2.25)
    """

    body_length: float
    leg_length: float
    half_width: float

    def __post_init__(self) -> None:
        for name in ("body_length", "leg_length", "half_width"):
            if not (value := getattr(self, name)) > 0:
                raise ValueError(f"{name} must be positive, got {value}")

    def hips(self, tripod: int) -> Array:
        """Hips of tripod 1 or 2, x forward from the body's middle, shape (3, 2)."""
        x, y = self.body_length * _ROWS, self.half_width * _SIDES[tripod]
        return np.stack([x, y], axis=-1)

    def feet(self, tripod: int, phi: ArrayLike) -> Array:
        """Feet of tripod 1 or 2 at angles of shape (...), shape (..., 3, 2)."""
        phi = np.asarray(phi, dtype=float)[..., None]
        reach = np.broadcast_arrays(-np.sin(phi), np.cos(phi) * _SIDES[tripod])
        return self.hips(tripod) + self.leg_length * np.stack(reach, axis=-1)

    def bounds(self, phi: ArrayLike) -> tuple[Array, Array]:
        """Least and largest b that a loaded tripod at phi carries without tipping.

        Both bounds hold for either tripod, within a quarter turn: l_b/4 + l sin(phi) <=
        b <= 3 l_b/4 + l sin(phi). Sec. 6 prints one for each.
        """
        swept = self.leg_length * np.sin(np.asarray(phi, dtype=float))
        return self.body_length / 4 + swept, 3 * self.body_length / 4 + swept

    def margin_along_axis(self, phi: ArrayLike, b: ArrayLike) -> Array:
        """Distance from the weight to the nearer bound along x, positive inside.

        The stability margin, to the nearest side, is shorter: the sides are oblique.
        """
        low, high = self.bounds(phi)
        b = np.asarray(b, dtype=float)
        return np.minimum(b - low, high - b)
