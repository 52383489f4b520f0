"""Routes: nominal paths around obstacles for scenarios that give only a goal.

A route is found by OMPL's RRT-Connect among the curves of Reeds and Shepp, that is arcs
and straight lines with the heading along them, forward or backward, and shortened by
OMPL's simplifier. A robot that walks along its heading needs no brackets.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from planner import Array, BoundError
from planner.support import point, tick
from sim.errors import UsageError, message
from sim.obstacles.clearance import Surroundings, surroundings
from sim.preparation.setup import Setup
from sim.scenarios import body_path as nominal
from sim.scenarios.body_path import NominalPath, Pose

Ompl = Any  # modules and objects of OMPL, which have no types

SIDE_ROOM = (0.03, 0.02, 0.01, 0.005)  # for the tube [m], the most that can be had
TRIALS = 5000  # samples for all searches; some seconds where there is no way
SEARCHES = 8  # of which the shortest way is taken
TIGHTEST = 0.5  # arc, in radii of the robot's outline
CHORD = 0.02  # [m] of the way, at most; half a millimetre off the tightest arc


def routed(setup: Setup) -> Setup:
    """The setup with a nominal path, where its scenario gives only a goal."""
    scenario = setup.scenario
    if scenario.path.kind != "route":
        return setup
    path = _around(setup) if scenario.obstacles else nominal.line(scenario.path.goal)
    return replace(setup, scenario=replace(scenario, path=path))


def _around(setup: Setup) -> NominalPath:
    """The first route found, with as much room on both sides as possible."""
    scenario, around = setup.scenario, surroundings(setup)
    least, goal = max(scenario.min_clearance, 0.0), scenario.path.goal
    postures = list(setup.raised.values())
    for name, pose in (("start", nominal.START), ("goal", goal)):
        _require_room(around, name, pose, postures, least)
    for room in SIDE_ROOM:
        search = _Search(around, goal, postures, least, room)
        if (found := search.run(scenario.seed, scenario.segments)) is not None:
            path = nominal.waypoints([tuple(pose) for pose in found.tolist()])
            return replace(path, goal=goal)
    clearance = least + SIDE_ROOM[-1]
    raise BoundError(message("no_way", goal=point(goal), room=1e3 * clearance))


def _require_room(
    around: Surroundings, name: str, pose: Pose, postures: Sequence[Array], least: float
) -> None:
    """Refuse a start or goal where the robot cannot stand or raise its legs."""
    qpos = np.concatenate([around.postures(np.array([pose]), up) for up in postures])
    clearances = around.clearances(qpos).least
    worst = int(clearances.argmin())
    if clearances[worst] <= least:
        part, obstacle = around.nearest(qpos[worst])
        facts = {"room": 1e3 * clearances[worst], "least": 1e3 * least}
        facts |= {"what": f"{name} {point(pose)}", "part": part, "obstacle": obstacle}
        raise BoundError(message("close", **facts))


class _Search:
    """Searches for a route that keeps a distance from obstacles."""

    def __init__(
        self,
        around: Surroundings,
        goal: Pose,
        postures: Sequence[Array],
        least: float,
        room: float,
    ) -> None:
        self.goal, self.room = goal, room
        origin = np.zeros((1, 3))
        qpos = np.concatenate([around.postures(origin, up) for up in postures])
        self.radius = max(map(around.outline.radius, qpos))
        self._area = around.area
        self._body = around.outline.solids.swept(qpos).buffer(least + room)
        self._near = self._area.buffer(self.radius + least + room)
        self._west, self._south, self._east, self._north = self._near.bounds
        shapely.prepare(self._body)
        shapely.prepare(self._near)

    def run(self, seed: int, segments: int) -> Array | None:
        """Poses (N, 3) of the shortest route found, for so many segments; or None."""
        if not all(self.is_free(*pose) for pose in (nominal.START, self.goal)):
            return None
        trials = iter(range(TRIALS))  # not a time, so that it is repeatable

        def spent() -> bool:
            return next(trials, None) is None

        seeds = range(SEARCHES * seed, SEARCHES * (seed + 1))
        if not (ways := [way for s in seeds if (way := self._once(s, spent))]):
            return None
        best = min(ways, key=lambda way: way.length())
        pieces = segments * math.ceil(best.length() / (segments * CHORD) or 1)
        best.interpolate(pieces + 1)
        way = np.array([_pose(state) for state in best.getStates()])
        way[:, 2] = np.unwrap(way[:, 2])
        way[:, 2] -= way[0, 2]
        turns = np.round((way[-1, 2] - self.goal[2]) / math.tau)
        way[0], way[-1] = nominal.START, self.goal  # exactly
        way[-1, 2] += math.tau * turns
        return way

    def _once(self, seed: int, done: Callable[[], bool]) -> Ompl:
        """A shortened route as an OMPL path; None if none is found until `done`."""
        try:
            from ompl import base, geometric, util
        except ImportError as error:
            raise UsageError.of("no_path", "path") from error
        util.setLogLevel(util.LOG_NONE)
        util.RNG.setSeed(seed + 1)  # 0 would mean the time of day
        space = base.ReedsSheppStateSpace(TIGHTEST * self.radius)
        space.setBounds(self._bounds(base))
        setup = geometric.SimpleSetup(space)
        setup.setStateValidityChecker(lambda state: self.is_free(*_pose(state)))
        information = setup.getSpaceInformation()
        # between the poses tested no point of the outline moves farther than the room
        step = self.room / (1 + 1 / TIGHTEST)
        information.setStateValidityCheckingResolution(step / space.getMaximumExtent())
        ends = [_state(space, pose) for pose in (nominal.START, self.goal)]
        straight = geometric.PathGeometric(information, *ends)
        if straight.check():
            return straight
        setup.setStartAndGoalStates(*ends, 1e-9)
        setup.setPlanner(geometric.RRTConnect(information))
        setup.solve(base.PlannerTerminationCondition(done))
        if not setup.haveExactSolutionPath():
            return None
        way = setup.getSolutionPath()
        geometric.PathSimplifier(information).simplifyMax(way)
        return way

    def is_free(self, x: float, y: float, yaw: float) -> bool:
        """Whether the robot keeps its distance when it stands there."""
        tick()
        around = self._west <= x <= self._east and self._south <= y <= self._north
        if not (around and shapely.intersects_xy(self._near, x, y)):
            return True
        cos, sin = math.cos(yaw), math.sin(yaw)
        turn = np.array([(cos, -sin), (sin, cos)])  # into the body's frame
        seen = shapely.transform(self._area, lambda points: (points - (x, y)) @ turn)
        return not shapely.intersects(self._body, seen)

    def _bounds(self, base: Ompl) -> Ompl:
        """Start, goal and all obstacles, with the width of a robot around them."""
        places = shapely.multipoints([nominal.START[:2], self.goal[:2]])
        west, south, east, north = shapely.union(self._area, places).bounds
        bounds = base.RealVectorBounds(2)
        for axis, (low, high) in enumerate(((west, east), (south, north))):
            bounds.setLow(axis, low - 2 * self.radius)
            bounds.setHigh(axis, high + 2 * self.radius)
        return bounds


def _pose(state: Ompl) -> Pose:
    return state.getX(), state.getY(), state.getYaw()


def _state(space: Ompl, pose: Pose) -> Ompl:
    state = space.allocState()
    state.setXY(*pose[:2])
    state.setYaw(math.remainder(pose[2], math.tau))
    return state
