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


@dataclass(frozen=True)
class Clearances:
    """An outline at consecutive samples of a motion."""

    clearance: Array  # of each part, shape (T, P) [m]; negative where it overlaps
    way: Array  # largest distance that a point of it moved, shape (T - 1,) [m]

    @property
    def least(self) -> Array:
        """Clearance of the whole outline at each sample, shape (T,) [m]."""
        return self.clearance.min(axis=1, initial=np.inf)

    @property
    def bound(self) -> Array:
        """Lower bound on the clearance between samples, shape (T - 1,) [m]."""
        ends = self.clearance[:-1] + self.clearance[1:]
        return (ends.min(axis=1, initial=np.inf) - ARC * self.way) / 2


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

    def clearances(self, qpos: Array) -> Clearances:
        """Clearances along samples (T, nq) of a motion, in the obstacles' frame."""
        cores = self.outline.solids.cores(qpos)
        radii = [part.radius for part in self.outline.solids.parts]
        clearance = [
            _distance(hulls(core), self.area) - radius
            for core, radius in zip(cores, radii, strict=True)
        ]
        moved = [
            np.linalg.norm(np.diff(core, axis=0), axis=-1).max(axis=-1)
            for core in cores
        ]
        return Clearances(np.stack(clearance, axis=-1), np.max(moved, axis=0))

    def nearest(self, qpos: Array) -> tuple[str, int]:
        """The part and the obstacle, counted from 1, that are closest to each other."""
        cores = self.outline.solids.cores(qpos[None])
        each = [
            [
                float(_distance(hulls(core), obstacle.area)[0]) - part.radius
                for obstacle in self.obstacles
            ]
            for core, part in zip(cores, self.outline.solids.parts, strict=True)
        ]
        part, obstacle = np.unravel_index(np.argmin(each), np.shape(each))
        return self.outline.solids.parts[part].name, int(obstacle) + 1


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
