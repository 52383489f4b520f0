"""Clearance of a robot's outline from obstacles, at samples of a motion and between.

Between two samples no part comes closer than half the sum of its distances at both,
less half the distance it moves. The samples of a motion therefore bound the clearance
of the whole motion from below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from planner import Array
from sim.obstacles.solids import Outline, hulls
from sim.preparation.setup import Setup
from sim.scenarios.obstacles import Obstacle

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
        """Joint positions (T, nq) of a robot at poses (T, 3), its legs at angle 0.

        Each group is raised by an angle, shape (G,) [rad].
        """
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
    ways = (np.linalg.norm(core[last] - core[first], axis=-1) for core in cores)
    return np.max([way.max(axis=-1) for way in ways], axis=0)


def surroundings(setup: Setup) -> Surroundings:
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
