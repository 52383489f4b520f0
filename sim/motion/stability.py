"""Support polygons, and stability margins of feet in contact.

The margin is the signed distance of the centre of mass, projected on the ground, to the
boundary of the convex hull of the feet in contact: positive inside, and with fewer than
three feet minus the distance to the segment or point.
"""

import numpy as np
import shapely

from models import Kinematics
from planner import Array

BLOCK = 20_000  # rows that are geometries at once, each of some hundred bytes


def support_polygons(points: Array, contact: Array) -> Array:
    """Convex hulls of the points (T, F, 2) in contact (T, F), row by row, shape (T,).

    They are polygons, segments, points, or nothing at all.
    """
    rows = np.nonzero(contact)[0]
    standing = shapely.points(points[contact])
    hulls = np.full(len(points), shapely.GeometryCollection(), dtype=object)
    some = np.unique(rows)
    hulls[some] = shapely.multipoints(standing, indices=np.searchsorted(some, rows))
    return shapely.convex_hull(hulls)


def stability_margin(points: Array, contact: Array, center_of_mass: Array) -> Array:
    """Signed distance of the centre of mass to the edge of the support polygon, (T,).

    Contact points have shape (T, F, 2), contacts (T, F), centres of mass (T, 2). It is
    minus infinity where nothing touches the ground.
    """
    margin = np.empty(len(points))
    for begin in range(0, len(points), BLOCK):
        rows = slice(begin, begin + BLOCK)
        hulls = support_polygons(points[rows], contact[rows])
        weight = shapely.points(center_of_mass[rows])
        flat = shapely.get_dimensions(hulls) < 2
        edges = np.where(flat, hulls, shapely.boundary(hulls))
        distance = shapely.distance(weight, edges)
        signed = np.where(~flat & shapely.covers(hulls, weight), distance, -distance)
        margin[rows] = np.where(shapely.is_empty(hulls), -np.inf, signed)
    return margin


def carrying(points: Array, contact: Array, center_of_mass: Array) -> Array:
    """Feet in contact; if there is none, the one whose last contact is nearest.

    Feet touch, or last did, at points (T, F, 2); centres of mass have shape (T, 3).
    """
    standing: Array = np.any(contact, axis=1)
    if standing.all():
        return contact
    far = np.linalg.norm(points - center_of_mass[:, None, :2], axis=2)
    return contact | ((far == far.min(axis=1, keepdims=True)) & ~standing[:, None])


class LeastMargin:
    """The least stability margin of many states, without computing all margins.

    While the same feet stand, the margin changes by no more than the distances that the
    centre of mass and the farthest foot have moved. States that cannot have the least
    margin are skipped; the result is the same as if all were computed.
    """

    STRIDE = 64  # at least one state in so many is computed

    def __init__(self) -> None:
        self.value = np.inf  # [m]

    def see(self, points: Array, contact: Array, center_of_mass: Array) -> None:
        """Add further states; arguments are those of `stability_margin`."""
        count = np.arange(len(points))
        changed = (contact[1:] != contact[:-1]).any(axis=1)
        on = (count % self.STRIDE == 0) | np.append(False, changed)  # anchors
        known = stability_margin(points[on], contact[on], center_of_mass[on])
        self.value = min(self.value, float(known.min()))
        of = np.cumsum(on) - 1  # the anchor before each state
        feet, weight = (np.abs(p - p[count[on][of]]) for p in (points, center_of_mass))
        moved = (feet[..., 0] + feet[..., 1]).max(axis=1)  # at most, as the weight did
        moved += weight[:, 0] + weight[:, 1]
        near = ~on & (known[of] - moved < self.value)
        if near.any():
            margin = stability_margin(points[near], contact[near], center_of_mass[near])
            self.value = min(self.value, float(margin.min()))


def margin_at_rest(kinematics: Kinematics, stratum: str) -> float:
    """Stability margin of a robot on a stratum, all its legs at angle 0 [m]."""
    stance, on = kinematics.standing, kinematics.robot.planted(stratum)
    feet, center = stance.feet[None], stance.center_of_mass[None]
    return float(stability_margin(feet, on[None], center)[0])
