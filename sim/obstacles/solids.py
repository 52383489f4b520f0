"""Solid parts of a robot seen from above, the floor below them, and its outline.

Every part is a convex core widened by a radius: a point for a sphere, a segment for a
capsule, the hull of its corners for a box or a mesh, so that distances are exact.
Cylinders and ellipsoids are covered by the capsule and the box around them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
import shapely

from models import ModelError, Robot
from models.contact import covering_core
from planner import Array


@dataclass(frozen=True)
class Part:
    """A solid part of the robot."""

    name: str  # of its geom
    geom: int  # index of the geom
    # points whose hull is the core, in the geom's own frame, shape (k, 3) [m]
    core: Array
    radius: float  # by which the core is widened [m]


@dataclass(frozen=True)
class Solids:
    """The parts of a robot that can collide."""

    model: mujoco.MjModel  # world that holds the robot
    root: int  # index of the body that carries its free joint

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Geoms of the robot that can collide."""
        model = self.model
        of_robot = np.flatnonzero(model.body_rootid[model.geom_bodyid] == self.root)
        solid = model.geom_contype | model.geom_conaffinity
        return tuple(_part(model, int(geom)) for geom in of_robot if solid[geom])

    def cores(self, qpos: Array) -> list[Array]:
        """Core of each part on the ground plane, shape (T, k, 2) [m]."""
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
        pairs = zip(self.cores(qpos), self.parts, strict=True)
        return np.stack([shapely.buffer(hulls(c), part.radius) for c, part in pairs])

    def swept(self, qpos: Array) -> shapely.Geometry:
        """The floor that the robot stands over in any configuration, shape (T, nq)."""
        return shapely.union_all(self.covered(qpos))


def hulls(points: Array) -> Array:
    """Convex hulls of sets of points (T, k, 2): points, segments or polygons, (T,)."""
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
    points = core.points
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:  # its hull collides
        from scipy.spatial import ConvexHull

        points = points[ConvexHull(points).vertices]
    return Part(name, geom, points, core.radius)


@dataclass(frozen=True)
class Outline:
    """A robot in a model, and the floor that it covers."""

    robot: Robot
    model: mujoco.MjModel

    @cached_property
    def solids(self) -> Solids:
        """Its solid parts."""
        return Solids(self.model, self.model.body(self.robot.root).id)

    def configurations(self, pose: Array, swing: Array, lift: Array) -> Array:
        """Joint positions (T, nq) of a level body at poses (T, 3).

        Groups have swing and lift angles, shape (T, G) [rad].
        """
        robot, model = self.robot, self.model
        qpos = np.tile(robot.start_qpos, (len(pose), 1))
        root = robot.root_address_in(model)
        qpos[:, root : root + 2] = pose[:, :2]
        half, zero = pose[:, 2] / 2, np.zeros(len(pose))
        upright = [np.cos(half), zero, zero, np.sin(half)]
        qpos[:, root + 3 : root + 7] = np.stack(upright, axis=-1)
        for joint, angle in robot.leg_angles(swing, lift).items():
            qpos[:, model.joint(joint).qposadr[0]] += angle
        return qpos

    def radius(self, qpos: Array) -> float:
        """Radius of the circle about the root's origin that contains the robot [m]."""
        root = self.robot.root_address_in(self.model)
        pairs = zip(self.solids.cores(qpos[None]), self.solids.parts, strict=True)
        ways = ((core[0] - qpos[root : root + 2], part.radius) for core, part in pairs)
        return max(float(np.linalg.norm(w, axis=-1).max()) + r for w, r in ways)
