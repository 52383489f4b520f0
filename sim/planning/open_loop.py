"""Plans for walks, of the whole path or the next segment, steered on a prediction.

The twists of the planner's fields are constant; those of real legs are not. The aim of
every segment is shifted by the error of its predicted end, in the frame of the
segment's start, and planned again until every predicted end lies on the nominal path.
Servos with a resolution move to whole counts; each segment is planned from the pose
that is predicted for rounded strokes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from math import ceil, floor

import numpy as np

from models import TwistModel
from models.motion import Strokes
from planner import Array, ConvergenceError, Flow, Path, Plan, RangeError, plan, rollout
from planner.execution import Coordinates
from planner.planning import Step, grid, plan_step, require_segments
from planner.support import tick
from planner.systems import merged
from sim.errors import message
from sim.experiments.identification import twist_model
from sim.motion.poses import compose, relative, wrap
from sim.preparation.setup import Setup

AIMING_ROUNDS = 12  # each at least halves the error, unless the prediction jumps
MET_WITHIN = 1e-7  # [m] and [rad]
TOLERATED_JUMP = 0.1  # tolerated error of a segment's end, as a part of its length
RANGE_ROUNDING = 1e-9  # [rad], beyond the joint range


def plan_open_loop(setup: Setup) -> Plan:
    """One plan for the whole path."""
    return list(open_loop_plans(setup))[-1]


def open_loop_plans(setup: Setup) -> Iterator[Plan]:
    """One plan for the whole path; before it a roughly aimed one, if aims take rounds.

    On ideal fields printed words need none, as their errors nearly cancel.
    """
    scenario = setup.scenario
    require_segments(scenario.segments, scenario.path.curve)
    if setup.servo.resolution:  # strokes end on counts, quasi-statically
        plan_along(setup, setup.nominal())  # refused where the joint range is too short
        twists, swings = twist_model(setup, "quasi_static"), setup.equations.swings
        pose, swing, plans = np.zeros(3), setup.at_rest.swing, list[Plan]()
        for segment in range(scenario.segments):
            own = plan_segment(setup, segment, pose, swing).plan
            pose = compose(pose, segment_ends(setup, own, twists, swing)[-1])
            changes = [np.multiply(swings[f.field], f.duration) for f in own.flows]
            swing = tuple(np.sum([np.array(swing), *changes], axis=0).tolist())
            plans.append(own)
        yield joined_plans(setup, plans)
    elif scenario.steer == "ideal" and scenario.words == "printed":
        yield plan_along(setup, setup.nominal())
    else:
        yield from steer_along(setup, twist_model(setup, scenario.steered_on))


def plan_replanned(setup: Setup) -> Plan:
    """All segments, each planned from the state that the exact kinematics reached."""
    state, plans = setup.nominal()(0.0), list[Plan]()
    for segment in range(setup.scenario.segments):
        plans.append(plan_segment(setup, segment, *split(setup, state)).plan)
        state = rollout(plans[-1])[-1]
    return joined_plans(setup, plans)


def split(setup: Setup, state: Array) -> tuple[Array, tuple[float, ...]]:
    """The pose (3,) of a configuration, and the angle of each group [rad]."""
    return state[:3], tuple(state[3 : 3 + len(setup.robot.groups)])


def plan_segment(
    setup: Setup,
    segment: int,
    pose: Array,
    swing: tuple[float, ...],
    meant: Array | None = None,
) -> Step:
    """Plan a segment, from 0 on, from the pose reached to its end on the nominal path.

    The predicted end meets the target. The groups begin at angles `swing`. If another
    motion is meant, shape (3,), seen from where the segment starts, it ends there.
    """
    target = segment_target(setup, segment)
    nearest = target[2] + wrap(pose[2] - target[2])  # by full turns
    here = np.array([*pose[:2], nearest])
    target = target if meant is None else compose(here, meant)
    twists = twist_model(setup, setup.scenario.steered_on)
    step = steer_towards(setup, twists, segment, target, here, swing)
    return _step_on_counts(setup, step, swing)


def segment_target(setup: Setup, segment: int) -> Array:
    """Pose of the nominal path at the end of a segment, shape (3,)."""
    nominal, segments = setup.nominal(), setup.scenario.segments
    require_segments(segments, setup.scenario.path.curve)
    return nominal(grid(nominal, segments)[segment + 1])[:3]


def _step_on_counts(setup: Setup, step: Step, swing: tuple[float, ...]) -> Step:
    """A step whose flows end on counts; as it is where servos have none."""
    if not setup.servo.resolution:
        return step
    angles, flows = np.array(swing), list[Flow]()
    for flow in merged(step.plan.flows):
        direction = np.array(setup.equations.swings[flow.field])
        leading = int(np.abs(direction).argmax())
        wanted = angles[leading] + direction[leading] * flow.duration
        reached = _count(setup, leading, wanted)
        duration = float((reached - angles[leading]) / direction[leading])
        angles = angles + direction * duration
        flows.append(flow._replace(duration=duration))
    kept = tuple(flow for flow in flows if flow.duration)
    return replace(step, plan=replace(step.plan, flows=kept, segment_ends=(len(kept),)))


def _count(setup: Setup, group: int, angle: float) -> float:
    """The nearest angle of a group, from rest, with its legs, or one, on counts."""
    robot, resolution = setup.robot, setup.servo.resolution
    legs = np.flatnonzero(robot.group_of_leg == group)
    gain = max(robot.swing_gain[legs], key=abs)
    gains = np.abs(robot.swing_gain[legs] / gain)
    for counts in range(1, 5):  # of the fastest, at which all are on some
        if np.abs(counts * gains - np.round(counts * gains)).max() < 0.02:  # counts
            resolution *= counts
            break
    low, high = setup.equations.limits[f"phi_{robot.groups[group]}"]
    inside = np.array([low - RANGE_ROUNDING, high + RANGE_ROUNDING])
    first, last = np.sort(gain * inside / resolution)
    count = np.clip(np.round(gain * angle / resolution), ceil(first), floor(last))
    return float(resolution * count / gain)


def joined_plans(setup: Setup, plans: list[Plan]) -> Plan:
    """Plans of consecutive segments as one."""
    nominal = setup.nominal()
    return replace(
        plans[0],
        flows=tuple(flow for own in plans for flow in own.flows),
        segment_ends=tuple(np.cumsum([len(own.flows) for own in plans]).tolist()),
        inputs=np.concatenate([own.inputs for own in plans]),
        hall_coordinates=np.concatenate([own.hall_coordinates for own in plans]),
        nominal=nominal.at(grid(nominal, setup.scenario.segments)),
    )


def plan_along(setup: Setup, path: Path, words: Coordinates | None = None) -> Plan:
    """One plan for a whole path, in the scenario's coordinates if none are given."""
    execution = replace(setup.execution(), coordinates=words or setup.coordinates)
    return plan(setup.extended, path, setup.scenario.segments, execution=execution)


def steer_along(setup: Setup, twists: TwistModel) -> Iterator[Plan]:
    """A roughly aimed plan, then one whose segments are predicted to end on the path.

    The prediction jumps where a bracket changes its sign, and would also where cheaper
    coordinates were chosen anew; there a segment may end a little beside the path.
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
        if len(tried) == 2:  # the third tells where it is too near to its bounds
            yield planned
        ends = segment_ends(setup, planned, twists)
        misses = np.abs(ends - goals).max(axis=1)
        if misses.max() < least:
            best, least, worst = planned, misses.max(), int(misses.argmax())
        if least < MET_WITHIN:
            break
        tried.append(aims)
        corrected.append(compose(aims, relative(relative(ends[:-1], ends[1:]), wanted)))
        plain = len(tried) <= 4  # as many as most walks need; extrapolated from then on
        aims = corrected[-1] if plain else _extrapolated(tried, corrected)
    if best is None or least > tolerable:
        raise unaimed(setup, f"segment {worst} of {len(wanted)}", float(least))
    yield best


def _extrapolated(aims: Sequence[Array], corrected: Sequence[Array]) -> Array:
    """The next aims (segments, 3) where errors shrink evenly (Anderson's method)."""
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

    A segment that the joint range cuts short is left as it is. Where the prediction
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
        what = f"segment {segment + 1} of {setup.scenario.segments}"
        raise unaimed(setup, what, least)
    return best


def segment_ends(
    setup: Setup, plan: Plan, twists: TwistModel, swing: tuple[float, ...] | None = None
) -> Array:
    """Predicted pose at the start and at the end of each segment, (segments + 1, 3).

    The walk begins with every group at `swing` [rad], or at angle 0.
    """
    swings, groups = setup.equations.swings, setup.robot.groups
    flows, start = plan.flows, np.zeros(len(groups)) if swing is None else swing
    moves = [(f.stratum, np.multiply(swings[f.field], f.duration)) for f in flows]
    strokes, loaded = Strokes.among(moves, groups, start)
    clock = np.concatenate([[0], np.cumsum(loaded)])
    ends = clock[[0, *plan.segment_ends]].astype(float)
    return strokes.travel(twists, setup.kinematics).pose(ends)


def _path(setup: Setup, start: Array, aims: Array) -> Path:
    """Straight from aim to aim, each taking an equal share of s."""
    poses = accumulate(aims, compose, initial=start)
    knots = np.array([setup.state(pose) for pose in poses])
    where = np.linspace(0.0, 1.0, len(knots))

    def at(s: Array) -> Array:
        return np.stack([np.interp(s, where, column) for column in knots.T], axis=1)

    return Path(at, corners=tuple(where[1:-1]))


def unaimed(setup: Setup, what: str, miss: float) -> ConvergenceError:
    """The error of what steering does not bring to its end, and what may help."""
    scenario = setup.scenario
    ways = f"give --segments {2 * scenario.segments}, or another --steer"
    if scenario.fields == "paper":
        ways = f"give --set fields=lifted, so that no foot has to drag, or {ways}"
    facts = {"what": what, "miss": 1e3 * miss, "steer": scenario.steer, "ways": ways}
    return ConvergenceError(message("still_misses", **facts))
