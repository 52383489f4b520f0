"""Plans for walks: of the whole path, or of the next segment.

The scenario names the prediction to steer on. The planner itself uses the ideal one.

Servos with a resolution move to whole counts. The effect of rounding the end of each
stroke is known beforehand, so the next segment is planned from the pose that is then
predicted, and errors do not add up. Nothing is measured: the walk is still open loop.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from planner import Flow, Plan, merged, rollout
from planner.planning import Step, grid, require_segments
from sim.experiments.predictions import twist_model
from sim.motion.poses import compose, nearest_turn
from sim.planning.aiming import plan_along, segment_ends, steer_along, steer_towards
from sim.preparation.setup import Setup

MOST_COUNTS = 4  # that are tried as one, for legs of other gains
ON_COUNT = 0.02  # counts, by which a leg may be off
RANGE_ROUNDING = 1e-9  # [rad], beyond the joint range


def plan_open_loop(setup: Setup) -> Plan:
    """One plan for the whole path.

    Errors of printed words nearly cancel from one segment to the next, so that plans on
    the ideal fields need no aiming; those of the shortest words add up.
    """
    scenario = setup.scenario
    require_segments(scenario.segments, scenario.path.curve)
    if setup.servo.resolution:
        return _on_counts(setup)
    if scenario.steer == "ideal" and scenario.words == "printed":
        return plan_along(setup, setup.nominal())
    return steer_along(setup, twist_model(setup, scenario.steered_on))


def plan_replanned(setup: Setup) -> Plan:
    """All segments, each planned from the state that the exact kinematics reached."""
    groups, state, plans = len(setup.robot.groups), setup.nominal()(0.0), list[Plan]()
    for segment in range(setup.scenario.segments):
        pose, swing = state[:3], tuple(state[3 : 3 + groups])
        plans.append(plan_segment(setup, segment, pose, swing).plan)
        state = rollout(plans[-1])[-1]
    return _joined(setup, plans)


def plan_segment(
    setup: Setup,
    segment: int,
    pose: np.ndarray,
    swing: tuple[float, ...],
    meant: np.ndarray | None = None,
) -> Step:
    """Plan a segment, from 0 on, from the pose reached to its end on the nominal path.

    The predicted end meets the target; the error of the paper's words is not left to
    the next segment, since there may be none. The groups swing by angles in radians.
    Where another motion is meant, shape (3,), seen from where the segment starts, its
    end is the target.
    """
    target = segment_target(setup, segment)
    here = np.array([*pose[:2], nearest_turn(pose[2], to=target[2])])
    if meant is not None:
        target = compose(here, meant)
    twists = twist_model(setup, setup.scenario.steered_on)
    step = steer_towards(setup, twists, segment, target, here, swing)
    return _step_on_counts(setup, step, swing)


def _on_counts(setup: Setup) -> Plan:
    """One plan whose strokes end on the servos' counts.

    What rounding adds to each segment or takes away is made good by the next one, which
    is planned from where the quasi-static prediction stands.
    """
    plan_along(setup, setup.nominal())  # refused where the joint range is too short
    twists = twist_model(setup, "quasi_static")
    swings = setup.equations.swings
    pose, swing, plans = np.zeros(3), setup.at_rest.swing, list[Plan]()
    for segment in range(setup.scenario.segments):
        plan = plan_segment(setup, segment, pose, swing).plan
        pose = compose(pose, segment_ends(setup, plan, twists, swing)[-1])
        changes = [np.multiply(swings[f.field], f.duration) for f in plan.flows]
        swing = tuple(np.sum([np.array(swing), *changes], axis=0).tolist())
        plans.append(plan)
    return _joined(setup, plans)


def segment_target(setup: Setup, segment: int) -> np.ndarray:
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
    flows = [flow for flow in flows if flow.duration]
    plan = replace(step.plan, flows=tuple(flows), segment_ends=(len(flows),))
    return replace(step, plan=plan)


def _count(setup: Setup, group: int, angle: float) -> float:
    """The angle nearest to one of a group at which its legs are on counts.

    Where gains allow it that is so of all of them, else of the one that swings most.
    """
    robot, resolution = setup.robot, setup.servo.resolution
    legs = np.flatnonzero(robot.group_of_leg == group)
    fastest = legs[np.abs(robot.swing_gain[legs]).argmax()]
    gain = robot.swing_gain[fastest]
    joint = robot.card.legs[robot.legs[fastest]].swing
    standing = robot.standing_angle(joint)
    gains = np.abs(robot.swing_gain[legs] / gain)
    for counts in range(1, MOST_COUNTS + 1):  # of the fastest, at which all are on some
        if np.abs(counts * gains - np.round(counts * gains)).max() < ON_COUNT:
            resolution *= counts
            break
    low, high = setup.equations.limits[f"phi_{robot.groups[group]}"]
    count = np.round((standing + gain * angle) / resolution)
    around = (resolution * (count + np.array([0, 1, -1])) - standing) / gain
    within = (around >= low - RANGE_ROUNDING) & (around <= high + RANGE_ROUNDING)
    return float(around[within][np.abs(around[within] - angle).argmin()])


def _joined(setup: Setup, plans: list[Plan]) -> Plan:
    """Plans of consecutive segments as one."""
    nominal = setup.nominal()
    return replace(
        plans[0],
        flows=tuple(flow for plan in plans for flow in plan.flows),
        segment_ends=tuple(np.cumsum([len(plan.flows) for plan in plans]).tolist()),
        inputs=np.concatenate([plan.inputs for plan in plans]),
        hall_coordinates=np.concatenate([plan.hall_coordinates for plan in plans]),
        nominal=nominal.at(grid(nominal, setup.scenario.segments)),
    )
