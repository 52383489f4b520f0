"""Plans whose strokes end on the counts of a servo.

A servo moves to whole counts. The effect of rounding the end of each stroke is known
beforehand, so the next segment is planned from the pose that is then predicted, and
errors do not add up. Nothing is measured: the walk is still open loop.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from planner import Array, Flow, Plan, merged
from planner.planning import Step, grid
from sim.preparation.setup import Setup

MOST = 4  # counts that are tried as one, for legs of other gains
ON_COUNT = 0.02  # counts, by which a leg may be off
SLACK = 1e-9  # [rad]; of the joint range, for rounding


def on_counts(setup: Setup, step: Step, swing: tuple[float, ...]) -> Step:
    """A step whose flows end on counts; as it is where servos have none.

    Args:
        setup: What to walk, with the servos' resolution.
        step: What was planned.
        swing: Angle of every group before it [rad].
    """
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


def angles_after(
    setup: Setup, plan: Plan, swing: tuple[float, ...]
) -> tuple[float, ...]:
    """Angle of every group after a plan [rad].

    Args:
        setup: What to walk.
        plan: Flows.
        swing: Angle of every group before them [rad].
    """
    changes: list[Array] = [
        np.multiply(setup.equations.swings[flow.field], flow.duration)
        for flow in plan.flows
    ]
    return tuple(np.sum([np.array(swing), *changes], axis=0).tolist())


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
    resolution *= _together(np.abs(robot.swing_gain[legs] / gain))
    low, high = setup.equations.limits[f"phi_{robot.groups[group]}"]
    count = np.round((standing + gain * angle) / resolution)
    around = (resolution * (count + np.array([0, 1, -1])) - standing) / gain
    within = (around >= low - SLACK) & (around <= high + SLACK)
    return float(around[within][np.abs(around[within] - angle).argmin()])


def _together(gains: Array) -> int:
    """Counts of the fastest leg after which all legs of a group are on counts; or 1."""
    for counts in range(1, MOST + 1):
        if np.abs(counts * gains - np.round(counts * gains)).max() < ON_COUNT:
            return counts
    return 1


def joined(setup: Setup, plans: list[Plan]) -> Plan:
    """Plans of consecutive segments as one."""
    nominal = setup.nominal()
    between: Array = nominal.at(grid(nominal, setup.scenario.segments))
    return replace(
        plans[0],
        flows=tuple(flow for plan in plans for flow in plan.flows),
        segment_ends=tuple(np.cumsum([len(plan.flows) for plan in plans]).tolist()),
        inputs=np.concatenate([plan.inputs for plan in plans]),
        hall_coordinates=np.concatenate([plan.hall_coordinates for plan in plans]),
        nominal=between,
    )
