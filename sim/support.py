"""Support polygon and stability margin: how far the weight is from tipping over.

The margin is the signed distance of the centre of mass, projected on the ground, to the
boundary of the convex hull of the feet in contact: positive inside, and with fewer than
three feet minus the distance to the segment or point.
"""

from __future__ import annotations

import numpy as np
import shapely

Array = np.ndarray


def support_polygons(points: Array, contact: Array) -> Array:
    """Convex hull of the points in contact, row by row.

    Args:
        points: Contact points, shape (T, F, 2) [m].
        contact: Which of them carry load, shape (T, F), bool.

    Returns:
        Shapely geometries, shape (T,): polygons, segments, points, or nothing at all.
    """
    rows = np.nonzero(contact)[0]
    standing = shapely.points(points[contact])
    hulls = np.full(len(points), shapely.GeometryCollection(), dtype=object)
    some = np.unique(rows)
    hulls[some] = shapely.multipoints(standing, indices=np.searchsorted(some, rows))
    return np.asarray(shapely.convex_hull(hulls))


def stability_margin(points: Array, contact: Array, center_of_mass: Array) -> Array:
    """Signed distance of the centre of mass to the edge of the support polygon.

    Args:
        points: Contact points, shape (T, F, 2) [m].
        contact: Which of them carry load, shape (T, F), bool.
        center_of_mass: Shape (T, 2) [m], in the frame of the points.

    Returns:
        Shape (T,) [m]; minus infinity where nothing touches the ground.
    """
    hulls = support_polygons(points, contact)
    weight = shapely.points(center_of_mass)
    flat = shapely.get_dimensions(hulls) < 2
    edges = np.where(flat, hulls, shapely.boundary(hulls))
    distance = shapely.distance(weight, edges)
    inside = ~flat & shapely.covers(hulls, weight)
    margin = np.where(inside, distance, -distance)
    return np.where(shapely.is_empty(hulls), -np.inf, margin)
