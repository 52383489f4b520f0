"""Solid parts of a robot seen from above, and the floor below them.

Every part is a convex core widened by a radius: a point for a sphere, a segment for a
capsule, the hull of its corners for a box or a mesh. Distances are therefore exact, and
nothing round is approximated by polygons. Cylinders and ellipsoids are covered by the
capsule and the box around them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
import shapely

from models import ModelError
from models.contact import covering_core
from planner import Array


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
    """The parts of a robot that can collide.

    Attributes:
        model: World that holds the robot.
        root: Index of the body that carries its free joint.
    """

    model: mujoco.MjModel
    root: int

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Geoms of the robot that can collide."""
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
        for row, configuration in enumerate(qpos):  # MuJoCo takes one at a time
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
        return shapely.points(points[:, 0])
    if points.shape[1] == 2:
        return shapely.linestrings(points)
    return shapely.convex_hull(shapely.linestrings(points))


def _part(model: mujoco.MjModel, geom: int) -> Part:
    name, core = model.geom(geom).name, covering_core(model, geom)
    if core is None:
        raise ModelError(
            f"geom {name or geom} can collide, and its shape covers no definite floor; "
            "make it a sphere, a capsule, a box, a cylinder, an ellipsoid or a mesh"
        )
    is_mesh = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH
    points = _hull(core.points) if is_mesh else core.points
    return Part(name, geom, points, core.radius)


def _hull(points: Array) -> Array:
    """Corners of the convex hull, which is what collides of a mesh, shape (k, 3)."""
    from scipy.spatial import ConvexHull

    return points[ConvexHull(points).vertices]
