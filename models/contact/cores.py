"""Geoms as convex cores widened by a radius: all that contact and clearance need.

A sphere is a point, a capsule a segment, a box or a mesh the hull of its corners.
Cylinders and ellipsoids have no such core, but can be covered by a capsule and a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from planner import Array

Geom = mujoco.mjtGeom
_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))


@dataclass(frozen=True, slots=True)
class Core:
    """Points whose convex hull, widened by a radius, is a geom."""

    points: Array  # in the geom's frame, (k, 3) [m]
    radius: float = 0.0  # [m]


def core_of(model: mujoco.MjModel, geom: int) -> Core | None:
    """The core of a geom, None if its shape has none.

    Args:
        model: Compiled model.
        geom: Index of the geom.
    """
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case Geom.mjGEOM_SPHERE:
            return Core(np.zeros((1, 3)), float(size[0]))
        case Geom.mjGEOM_CAPSULE:
            return Core(ends(size), float(size[0]))
        case Geom.mjGEOM_BOX:
            return Core(_CORNERS * size)
        case Geom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            return Core(model.mesh_vert[first : first + count].astype(float))
    return None


def covering_core(model: mujoco.MjModel, geom: int) -> Core | None:
    """As `core_of`, with a cylinder's capsule and the box around an ellipsoid."""
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case Geom.mjGEOM_CYLINDER:
            return Core(ends(size), float(size[0]))
        case Geom.mjGEOM_ELLIPSOID:
            return Core(_CORNERS * size)
    return core_of(model, geom)


def ends(size: Array) -> Array:
    """Middles of both ends of a capsule or cylinder of that size, shape (2, 3) [m]."""
    return np.array([(0, 0, -size[1]), (0, 0, size[1])])
