"""Steering on a prediction: plans whose predicted motion meets the nominal path.

The twists of the planner's fields are constant; those of real legs are not. The aim of
every segment is shifted by the error of its predicted end, in the frame of the
segment's start, and all segments are planned again until every predicted end lies on
the nominal path. The resulting plan is still open loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from models import TwistModel
from models.motion import Strokes
from planner import Array, ConvergenceError, Path, Plan, RangeError, plan
from planner.execution import Coordinates
from planner.planning import Step, grid, plan_step
from planner.support import tick
from sim.motion.poses import compose, relative
from sim.preparation.setup import Setup

AIMING_ROUNDS = 12  # each at least halves the error, unless the prediction jumps
MET_WITHIN = 1e-7  # [m] and [rad]
PLAIN_ROUNDS = 4  # as many as most walks need; extrapolated from then on
TOLERATED_JUMP = 0.1  # tolerated error of a segment's end, as a part of its length


def plan_along(
    setup: Setup, path: Path, coordinates: Coordinates | None = None
) -> Plan:
    """One plan for a whole path, in the scenario's coordinates if none are given."""
    followed = coordinates or setup.coordinates
    execution = replace(setup.execution(), coordinates=followed)
    return plan(setup.extended, path, setup.scenario.segments, execution=execution)


def steer_along(setup: Setup, twists: TwistModel) -> Plan:
    """A plan whose every segment is predicted to end on the nominal path.

    Backward coordinates, or the shortest words, are used throughout: if the cheaper
    coordinates were chosen anew in each round, the prediction would jump. It still
    jumps where a bracket changes its sign; there a segment may end beside the path by
    a small part of its length.
    """
    nominal = setup.nominal()
    goals = np.array([nominal(s)[:3] for s in grid(nominal, setup.scenario.segments)])
    wanted = relative(goals[:-1], goals[1:])  # (segments, 3)
    tolerable = TOLERATED_JUMP * np.abs(wanted).max()
    aims, best, least, worst = wanted, None, np.inf, 0
    tried, corrected = list[Array](), list[Array]()
    steady = "backward" if setup.coordinates == "fewest" else setup.coordinates
    for _ in range(AIMING_ROUNDS):
        tick()
        try:
            planned = plan_along(setup, _path(setup, goals[0], aims), steady)
        except RangeError:
            if best is None or least <= tolerable:
                raise
            break  # the aims diverge
        ends = segment_ends(setup, planned, twists)
        misses = np.abs(ends - goals).max(axis=1)
        if misses.max() < least:
            best, least, worst = planned, misses.max(), int(misses.argmax())
        if least < MET_WITHIN:
            break
        off = relative(relative(ends[:-1], ends[1:]), wanted)
        tried.append(aims)
        corrected.append(compose(aims, off))
        slow = len(tried) > PLAIN_ROUNDS
        aims = _extrapolated(tried, corrected) if slow else corrected[-1]
    if best is None or least > tolerable:
        raise _failure(setup, worst - 1, float(least))  # misses[0] is the start's
    return best


def _extrapolated(aims: Sequence[Array], corrected: Sequence[Array]) -> Array:
    """The next aims (segments, 3), from those of all rounds and what corrects them.

    Where errors shrink evenly, their sum is met at once (Anderson's method).
    """
    tried, found = (np.reshape(each, (len(each), -1)) for each in (aims, corrected))
    errors, steps = np.diff(found - tried, axis=0).T, np.diff(found, axis=0).T
    shares = np.linalg.lstsq(errors, (found - tried)[-1], rcond=None)[0]
    return (found[-1] - steps @ shares).reshape(aims[0].shape)


def steer_towards(
    setup: Setup,
    twists: TwistModel,
    segment: int,
    target: Array,
    pose: Array,
    swing: tuple[float, ...],
) -> Step:
    """Plan one segment, from 0 on, from the pose reached to the target it shall meet.

    Both poses are in the start frame; `swing` is the angle of every group [rad]. A
    segment that the joint range cuts short is left as it is. Where the prediction
    jumps because other words become cheaper, the closest attempt is taken.
    """
    last = segment == setup.scenario.segments - 1
    execution = setup.execution(finish=last or setup.learns)
    here, wanted = setup.state(pose, swing), relative(pose, target)
    aim, best, least = wanted, None, np.inf
    for _ in range(AIMING_ROUNDS):
        tick()
        there = setup.state(compose(pose, aim))
        step = plan_step(setup.extended, here, there, execution)
        got = segment_ends(setup, step.plan, twists, swing)[-1]
        miss = float(np.abs(got - wanted).max())
        if step.fraction < 1 or miss < MET_WITHIN:
            return step
        if miss < least:
            best, least = step, miss
        aim = compose(aim, relative(got, wanted))
    if best is None or least > TOLERATED_JUMP * np.abs(wanted).max():
        raise _failure(setup, segment, least)
    return best


def segment_ends(
    setup: Setup,
    planned: Plan,
    twists: TwistModel,
    swing: tuple[float, ...] | None = None,
) -> Array:
    """Predicted pose at the start and at the end of each segment, (segments + 1, 3).

    The walk begins with every group at `swing` [rad], or at angle 0.
    """
    swings, groups = setup.equations.swings, setup.robot.groups
    moves = [
        (flow.stratum, np.multiply(swings[flow.field], flow.duration))
        for flow in planned.flows
    ]
    start = np.zeros(len(groups)) if swing is None else swing
    strokes, loaded = Strokes.among(moves, groups, start)
    clock = np.concatenate([[0], np.cumsum(loaded)])
    ends = clock[[0, *planned.segment_ends]].astype(float)
    return strokes.travel(twists, setup.kinematics).pose(ends)


def _path(setup: Setup, start: Array, aims: Array) -> Path:
    """Straight from aim to aim, each taking an equal share of s."""
    poses = accumulate(aims, compose, initial=start)
    knots = np.array([setup.state(pose) for pose in poses])
    where = np.linspace(0.0, 1.0, len(knots))

    def at(s: Array) -> Array:
        return np.stack([np.interp(s, where, column) for column in knots.T], axis=1)

    return Path(at, corners=tuple(where[1:-1]))


def _failure(setup: Setup, segment: int, miss: float) -> ConvergenceError:
    scenario = setup.scenario
    return ConvergenceError(
        f"segment {segment + 1} of {scenario.segments} still misses its end by "
        f"{1e3 * miss:.3g} mm or mrad, steered on the {scenario.steer} prediction; "
        "use more segments, or steer on another one"
    )
