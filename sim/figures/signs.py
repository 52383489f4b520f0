"""Static stability of the paper's stance by closed forms and by support polygons."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from models import PaperStance
from planner import Array
from sim.motion.stability import stability_margin, support_polygons

WIDEST = 1.2  # [rad] to either side of the angles compared


def polygon_margin(stance: PaperStance, tripod: int, phi: Array, b: Array) -> Array:
    """Margin by the support polygon, the weight on the body's axis, shape as phi.

    Args:
        stance: Lengths.
        tripod: The loaded tripod, 1 or 2.
        phi: Its angle [rad].
        b: Distance of the weight from the front, same shape.
    """
    weight = np.stack([stance.body_length / 2 - b, np.zeros_like(b)], axis=-1)
    feet = stance.feet(tripod, phi)
    standing = np.ones(feet.shape[:-1], dtype=bool)
    return stability_margin(feet, standing, weight)


@dataclass(frozen=True)
class SignMap:
    """Both margins on a grid of angles and places of the weight."""

    phi: Array  # (P,) [rad]
    b: Array  # (B,)
    closed: Array  # (B, P)
    polygon: Array  # of tripods 1 and 2, (2, B, P)

    @property
    def disagreements(self) -> int:
        """Points at which the signs differ by more than rounding, of both tripods."""
        off = np.abs(self.closed) > 1e-12
        return int((np.sign(self.polygon) != np.sign(self.closed))[:, off].sum())


def sign_map(stance: PaperStance, points: int = 121) -> SignMap:
    """Compare the closed form with the support polygon everywhere."""
    phi = np.linspace(-WIDEST, WIDEST, points)
    b = np.linspace(-0.5, 1.5, points) * stance.body_length
    at_phi, at_b = (grid.ravel() for grid in np.meshgrid(phi, b))
    polygon = [polygon_margin(stance, tripod, at_phi, at_b) for tripod in (1, 2)]
    closed = stance.margin_along_axis(at_phi, at_b).reshape(points, points)
    return SignMap(phi, b, closed, np.reshape(polygon, (2, points, points)))


def crossings(stance: PaperStance, tripod: int, phi: Array) -> Array:
    """Least and largest b at which the body's axis is inside the support polygon.

    Args:
        stance: Lengths.
        tripod: The loaded tripod, 1 or 2.
        phi: Its angle, shape (P,) [rad].

    Returns:
        Shape (2, P).
    """
    feet = stance.feet(tripod, phi)
    polygons = support_polygons(feet, np.ones(feet.shape[:-1], dtype=bool))
    far = 2 * (stance.body_length + stance.leg_length)
    axis = shapely.LineString([(-far, 0), (far, 0)])
    rear, _, front, _ = shapely.bounds(shapely.intersection(polygons, axis)).T
    return stance.body_length / 2 - np.array([front, rear])
