"""Clearance of a robot's outline from obstacles, at samples of a motion and between.

Every solid part of the robot, seen from above, is a convex core widened by a radius, so
that distances are exact; cylinders and ellipsoids are covered by the capsule and the
box around them. Between two samples no part comes closer than half the sum of its
distances at both, less half the distance it moves: samples bound the whole motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import shapely

from models import ModelError, Robot
from models.contact import covering_core
from planner import Array
from sim.errors import message
from sim.scenarios.obstacles import Obstacle

if TYPE_CHECKING:  # films need none of what it loads
    from sim.preparation.setup import Setup


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
        data = mujoco.MjData(self.model)
        now, place, turn = data.qpos, data.geom_xpos, data.geom_xmat
        places = np.empty((len(qpos), *place.shape))
        turns = np.empty((len(qpos), *turn.shape))
        for row, configuration in enumerate(qpos):  # MuJoCo takes one at a time
            now[:] = configuration
            mujoco.mj_kinematics(self.model, data)
            places[row], turns[row] = place, turn
        turns = turns.reshape(*places.shape, 3)

        def core(part: Part) -> Array:  # on long rows, (2, k, T), which is faster
            turn = np.ascontiguousarray(turns[:, part.geom, :2].T)
            points = np.einsum("jit,kj->ikt", turn, part.core)
            return (points + places[:, part.geom, :2].T[:, None]).T

        return [core(part) for part in self.parts]

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
        raise ModelError(message("no_core", geom=name or geom))
    points = core.points
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:  # its hull collides
        from scipy.spatial import ConvexHull

        points = points[ConvexHull(points).vertices]
    return Part(name, geom, points, core.radius)


@dataclass(frozen=True)
class Outline:
    """A robot in a model with a keyframe `start`, and the floor that it covers."""

    robot: Robot
    model: mujoco.MjModel

    @cached_property
    def solids(self) -> Solids:
        """Its solid parts."""
        return Solids(self.model, self.model.body(self.robot.root).id)

    def configurations(self, pose: Array, swing: Array, lift: Array) -> Array:
        """Joint positions (T, nq) at level poses (T, 3), group angles (T, G) [rad]."""
        robot, model = self.robot, self.model
        qpos = np.tile(model.key("start").qpos, (len(pose), 1))
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


ARC = 1.01  # largest ratio of the distance moved to the chord between samples
APART = 16  # samples of which one is measured, where all between are far away

Rows = Array | slice


@dataclass(frozen=True)
class Clearances:
    """An outline at consecutive samples of a motion."""

    clearance: Array  # of each part, shape (T, P) [m]; negative where it overlaps
    cores: Sequence[Array]  # of each part on the ground plane, shape (T, k, 2) [m]

    @property
    def least(self) -> Array:
        """Clearance of the whole outline at each sample, shape (T,) [m]."""
        return self.clearance.min(axis=1, initial=np.inf)

    @property
    def bound(self) -> Array:
        """Lower bound on the clearance between samples, shape (T - 1,) [m]."""
        return self.between(slice(None, -1), slice(1, None))

    def between(self, first: Rows, last: Rows) -> Array:
        """Lower bound on the clearance on the way from some samples to others [m]."""
        ends = self.clearance[first] + self.clearance[last]
        way = _moved(self.cores, first, last)
        return (ends.min(axis=1, initial=np.inf) - ARC * way) / 2


@dataclass(frozen=True)
class Surroundings:
    """Obstacles around a robot."""

    outline: Outline
    obstacles: Sequence[Obstacle]

    @cached_property
    def area(self) -> shapely.Geometry:
        """The part of the floor that the obstacles cover."""
        return shapely.union_all([obstacle.area for obstacle in self.obstacles])

    def postures(self, pose: Array, raised: Array) -> Array:
        """Joint positions (T, nq) at poses (T, 3), groups raised, (G,) [rad]."""
        angles = np.zeros((len(pose), len(raised)))
        return self.outline.configurations(pose, angles, angles + raised)

    def clearances(self, qpos: Array, enough: float = np.inf) -> Clearances:
        """Clearances along samples (T, nq) of a motion, in the obstacles' frame.

        A part that is farther away than `enough`, on the way to the next sample too,
        may have a lower bound of its clearance in its place.
        """
        cores = self.outline.solids.cores(qpos)
        way = _moved(cores, slice(None, -1), slice(1, None))
        enough += ARC * way.max(initial=0.0)
        gone = np.append(0.0, np.cumsum(way))
        clearance = [
            self._along(core, gone, enough + part.radius) - part.radius
            for core, part in zip(cores, self.outline.solids.parts, strict=True)
        ]
        return Clearances(np.stack(clearance, axis=-1), cores)

    def _along(self, core: Array, gone: Array, enough: float) -> Array:
        """Distances of a core, which moves no farther than what is gone between."""
        samples = np.arange(len(core))
        if enough == np.inf:
            return _distance(hulls(core), self.area)
        measured = np.union1d(samples[::APART], samples[-1:])
        known = _distance(hulls(core[measured]), self.area)
        before = np.searchsorted(measured, samples, side="right") - 1
        after = np.searchsorted(measured, samples)
        distance: Array = np.maximum(
            known[before] - (gone - gone[measured[before]]),
            known[after] - (gone[measured[after]] - gone),
        )
        near = distance <= enough
        distance[near] = _distance(hulls(core[near]), self.area)
        return distance

    def nearest(self, qpos: Array) -> tuple[str, int]:
        """The part and the obstacle, counted from 1, that are closest to each other."""
        parts = self.outline.solids.parts
        cores = map(hulls, self.outline.solids.cores(qpos[None]))
        each = [
            [float(_distance(core, o.area)[0]) - part.radius for o in self.obstacles]
            for core, part in zip(cores, parts, strict=True)
        ]
        part, obstacle = np.unravel_index(np.argmin(each), np.shape(each))
        return parts[part].name, int(obstacle) + 1


def _moved(cores: Sequence[Array], first: Rows, last: Rows) -> Array:
    """Largest distance between the points of cores at some samples and at others."""
    ways = (((core[last] - core[first]) ** 2).sum(axis=-1) for core in cores)
    return np.sqrt(np.max([way.max(axis=-1) for way in ways], axis=0))


def surroundings(setup: "Setup") -> Surroundings:
    """A scenario's obstacles and the outline of its robot."""
    return Surroundings(Outline(setup.robot, setup.model), setup.scenario.obstacles)


def _distance(cores: Array, area: shapely.Geometry) -> Array:
    """Signed distance: for a core inside, minus the depth of its deepest corner."""
    distance = shapely.distance(cores, area)
    inside = np.flatnonzero(distance == 0)
    if inside.size:
        points, owner = shapely.get_coordinates(cores[inside], return_index=True)
        covered = shapely.intersects_xy(area, points)
        depth = shapely.distance(shapely.points(points), shapely.boundary(area))
        deepest = np.zeros(inside.size)
        np.maximum.at(deepest, owner, np.where(covered, depth, 0.0))
        distance[inside] = -deepest
    return distance
