"""Changes of a scenario that may bring its plan nearer to the goal."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from planner import Array, play
from planner.planning import recut
from sim.motion.poses import wrap
from sim.planning.aiming import plan_along
from sim.planning.remedies import Offer
from sim.planning.replanned import replanned
from sim.preparation.setup import Setup

TIMES = (4, 16)  # as many segments
WIDER = 1.5  # times the joint range


def miss_of(setup: Setup, pose: Array, goal: Array) -> float:
    """How far a pose is off a goal, as a share of the way there.

    The yaw counts as the way of the feet when the body turns by it.

    Args:
        setup: What is walked.
        pose: Pose reached, shape (3,).
        goal: Pose wanted, shape (3,).
    """
    arm = setup.kinematics.reach
    turn = abs(setup.nominal()(1.0)[2])
    way = max(setup.scenario.path.length, arm * turn)
    off = max(math.dist(pose[:2], goal[:2]), arm * abs(wrap(pose[2] - goal[2])))
    return float(off / way) if way else 0.0


def offers(setup: Setup) -> Iterator[Offer]:
    """Changes to try, the cheapest first.

    Args:
        setup: What is walked; where it is replanned, so are the changes.
    """
    scenario, degree = setup.scenario, setup.extended.steering.degree
    if scenario.words == "printed":
        mirrored = replace(setup, scenario=replace(scenario, words="symmetric"))
        yield "--words symmetric", lambda: _miss(mirrored)
    higher = f"--degree {degree + 1}"
    yield higher, lambda: _miss(_to_degree(setup, degree + 1))
    for times in TIMES:
        count = times * scenario.segments
        finer = replace(setup, scenario=replace(scenario, segments=count))
        yield f"--segments {count}", lambda finer=finer: _miss(finer)  # type: ignore[misc]
    if not scenario.replan:
        yield "--replan", lambda: _replanned_miss(setup)
    yield "a joint range half as wide again", lambda: _miss(_wider(setup))
    if not scenario.replan:
        yield "half of the way", lambda: _miss(setup, 0.5)


def _replanned_miss(setup: Setup) -> float:
    start, goal = setup.nominal()(0.0), setup.nominal()(1.0)
    end = play(setup.equations.system, replanned(setup), start)[-1]
    return miss_of(setup, end[:3], goal[:3])


def _to_degree(setup: Setup, degree: int) -> Setup:
    return replace(setup, extended=setup.extended.to_degree(degree))


def _wider(setup: Setup) -> Setup:
    limits = {
        name: (WIDER * low, WIDER * high)
        for name, (low, high) in setup.equations.limits.items()
    }
    return replace(setup, equations=replace(setup.equations, limits=limits))


def _miss(setup: Setup, share: float = 1.0) -> float:
    """What a plan for the first part of the way misses of its end."""
    if setup.scenario.replan:
        return _replanned_miss(setup)
    path = setup.nominal()
    if share < 1:
        corners = [corner for corner in path.corners if corner < share]
        path = recut(path, np.array([0.0, *corners, share]))
    planned = plan_along(setup, path)
    end = play(planned.system, planned.flows, path(0.0))[-1]
    return miss_of(setup, end[:3], path(1.0)[:3]) / share
