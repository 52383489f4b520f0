"""Soles: the lowest points of the feet's geoms when the robot stands.

A geom is a convex core widened by a radius: a sphere is a point, a capsule a segment, a
box or a mesh the hull of its corners. Cylinders and ellipsoids have no such core, but
can be covered by a capsule and a box. A round geom touches the floor vertically below a
point that is fixed in the leg; one with edges or corners touches with these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from models.errors import ModelError
from planner import Array

Geom = mujoco.mjtGeom
_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))


@dataclass(frozen=True, slots=True)
class Core:
    """Points whose convex hull, widened by a radius, is a geom."""

    points: Array  # in the geom's frame, (k, 3) [m]
    radius: float = 0.0  # [m]


def covering_core(model: mujoco.MjModel, geom: int) -> Core | None:
    """The core of a geom, if any; a cylinder's capsule, the box of an ellipsoid."""
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case Geom.mjGEOM_SPHERE:
            return Core(np.zeros((1, 3)), float(size[0]))
        case Geom.mjGEOM_CAPSULE | Geom.mjGEOM_CYLINDER:
            return Core(_ends(size), float(size[0]))
        case Geom.mjGEOM_BOX | Geom.mjGEOM_ELLIPSOID:
            return Core(_CORNERS * size)
        case Geom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            return Core(model.mesh_vert[first : first + count].astype(float))
    return None


def _ends(size: Array) -> Array:
    return np.array([(0, 0, -size[1]), (0, 0, size[1])])


TIED = 1e-4  # [m]; points that are this close to the lowest one touch as well


@dataclass(frozen=True)
class Sole:
    """Points of a leg; the floor acts below their mean."""

    geoms: Array  # geom that each belongs to, (n,)
    points: Array  # in that geom's frame, (n, 3) [m]
    depth: float  # distance from the points down to the floor [m]

    def touch(self, data: mujoco.MjData) -> Array:
        """Contact point of the foot, provided that it touches, shape (3,)."""
        return self.placed(data).mean(axis=0) - (0.0, 0.0, self.depth)

    def placed(self, data: mujoco.MjData) -> Array:
        """Its points in the world, shape (n, 3)."""
        return _place(data, self.geoms, self.points)


def find_sole(model: mujoco.MjModel, data: mujoco.MjData, foot: Sequence[str]) -> Sole:
    """The sole of a foot with these geoms, as the robot stands."""
    numbers = [model.geom(name).id for name in foot]
    cores = [_lowest_core(model, data, geom) for geom in numbers]
    counts = [len(core.points) for core in cores]
    geoms, depths = (
        np.repeat(numbers, counts),
        np.repeat([c.radius for c in cores], counts),
    )
    points = np.concatenate([core.points for core in cores])
    bottom = _place(data, geoms, points)[:, 2] - depths
    lowest = bottom <= bottom.min() + TIED
    return Sole(geoms[lowest], points[lowest], float(depths[lowest].mean()))


def _place(data: mujoco.MjData, geoms: Array, points: Array) -> Array:
    """Points in world coordinates, (n, 3)."""
    turned = np.einsum("nij,nj->ni", data.geom_xmat[geoms].reshape(-1, 3, 3), points)
    return data.geom_xpos[geoms] + turned


def _lowest_core(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Core:
    """The core of a geom; of a cylinder or ellipsoid its lowest points.

    Those of a cylinder are on its two rims, or their middles where it stands upright.
    """
    size, kind = model.geom_size[geom], model.geom_type[geom]
    down = -data.geom_xmat[geom].reshape(3, 3)[2]  # in the geom's frame
    if kind == Geom.mjGEOM_CYLINDER:
        across = np.append(down[:2], 0.0)
        length = float(np.linalg.norm(across))
        return Core(_ends(size) + across * (size[0] / length if length > 1e-6 else 0.0))
    if kind == Geom.mjGEOM_ELLIPSOID:
        return Core((size**2 * down / np.linalg.norm(size * down))[None])
    if (core := covering_core(model, geom)) is not None:
        return core
    shape = Geom(kind).name.removeprefix("mjGEOM_").lower()
    raise ModelError(
        f"foot {model.geom(geom).name!r} is a {shape}: give it a sphere, a capsule, a "
        "box, a cylinder, an ellipsoid or a mesh to stand on"
    )
