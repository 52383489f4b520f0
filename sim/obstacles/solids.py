"""Solid parts of a robot seen from above: the floor that they stand over.

Every part is a convex core widened by a radius: a point for a sphere, a segment for a
capsule, the hull of its corners for a box or a mesh. So distances are exact and nothing
round is cut into polygons. Cylinders and ellipsoids are covered by the capsule and the
box around them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
import shapely

from planner import Array

Shape = mujoco.mjtGeom

_CORNERS = np.array(
    [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float
)


@dataclass(frozen=True)
class Part:
    """A solid part of the robot.

    Attributes:
        name: Of its geom.
        geom: Index of the geom.
        core: Points whose hull is the core, in the geom's own frame, shape (k, 3) [m].
        radius: By which the core is widened [m].
    """

    name: str
    geom: int
    core: Array
    radius: float


@dataclass(frozen=True)
class Solids:
    """What of a robot can collide with anything.

    Attributes:
        model: World that holds the robot.
        root: Index of the body that carries its free joint.
    """

    model: mujoco.MjModel
    root: int

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Geoms of the robot that can collide with anything."""
        model = self.model
        of_robot = np.flatnonzero(model.body_rootid[model.geom_bodyid] == self.root)
        solid = model.geom_contype | model.geom_conaffinity
        return tuple(_part(model, int(geom)) for geom in of_robot if solid[geom])

    def cores(self, qpos: Array) -> list[Array]:
        """Cores of all parts on the ground plane.

        Args:
            qpos: Joint positions, shape (T, nq).

        Returns:
            For each part the points of its core, shape (T, k, 2) [m].
        """
        geoms = [part.geom for part in self.parts]
        places = np.empty((len(qpos), len(geoms), 3))
        turns = np.empty((len(qpos), len(geoms), 9))
        data = mujoco.MjData(self.model)
        for row, configuration in enumerate(qpos):  # the engine knows one at a time
            data.qpos = configuration
            mujoco.mj_kinematics(self.model, data)
            places[row], turns[row] = data.geom_xpos[geoms], data.geom_xmat[geoms]
        ground = turns.reshape(len(qpos), -1, 3, 3)[:, :, :2]
        return [
            places[:, i, None, :2] + np.einsum("tij,kj->tki", ground[:, i], part.core)
            for i, part in enumerate(self.parts)
        ]

    def covered(self, qpos: Array) -> Array:
        """The floor under each part in each configuration, shapely, (parts, T)."""
        return np.stack(
            [
                shapely.buffer(hulls(core), part.radius)
                for core, part in zip(self.cores(qpos), self.parts, strict=True)
            ]
        )

    def swept(self, qpos: Array) -> shapely.Geometry:
        """The floor that the robot stands over in any configuration, shape (T, nq)."""
        return shapely.union_all(self.covered(qpos))


def hulls(points: Array) -> Array:
    """Convex hulls of sets of points: points, segments or polygons.

    Args:
        points: Shape (T, k, 2).

    Returns:
        Shapely geometries, shape (T,).
    """
    if points.shape[1] == 1:
        return np.asarray(shapely.points(points[:, 0]))
    if points.shape[1] == 2:
        return np.asarray(shapely.linestrings(points))
    return np.asarray(shapely.convex_hull(shapely.linestrings(points)))


def _part(model: mujoco.MjModel, geom: int) -> Part:
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    if kind == Shape.mjGEOM_MESH:
        core, radius = _mesh_hull(model, int(model.geom_dataid[geom])), 0.0
    else:
        core, radius = _PRIMITIVES[kind](size)
    return Part(model.geom(geom).name, geom, core, radius)


def _capsule(size: Array) -> tuple[Array, float]:
    ends = np.array([(0, 0, -size[1]), (0, 0, size[1])])
    return ends, float(size[0])


_PRIMITIVES: Mapping[int, Callable[[Array], tuple[Array, float]]] = {
    int(Shape.mjGEOM_SPHERE): lambda size: (np.zeros((1, 3)), float(size[0])),
    int(Shape.mjGEOM_CAPSULE): _capsule,
    int(Shape.mjGEOM_CYLINDER): _capsule,
    int(Shape.mjGEOM_BOX): lambda size: (_CORNERS * size, 0.0),
    int(Shape.mjGEOM_ELLIPSOID): lambda size: (_CORNERS * size, 0.0),
}


def _mesh_hull(model: mujoco.MjModel, mesh: int) -> Array:
    """Corners of a mesh's convex hull, which is what collides, shape (k, 3)."""
    from scipy.spatial import ConvexHull

    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    vertices = model.mesh_vert[first : first + count].astype(float)
    return np.asarray(vertices[ConvexHull(vertices).vertices])
