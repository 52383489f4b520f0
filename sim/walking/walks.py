"""Walks in the physics: open loop, or planned again from every pose that is reached.

A robot that is not as it should be misses every segment by much the same. Planning from
the pose makes good what was missed, one segment late; what is likely to be missed is
allowed for beforehand, as `sim.feedback` has learnt it, for which all segments bring
the legs back to angle 0, as otherwise only the last one does.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from models import Robot, equations
from planner import Array, Plan
from planner.planning import Step
from sim.experiments.predictions import twist_model
from sim.feedback.filter import Feedback
from sim.feedback.sensing import Sensor
from sim.feedback.stops import Followed, Stop, stop_after
from sim.motion.schedule import LegState
from sim.planning.aiming import segment_ends
from sim.planning.open_loop import plan_segment, segment_target
from sim.planning.soundness import require_sound, require_sound_flows
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, silent
from sim.scenarios.body_path import waypoints
from sim.scenarios.scenario import Scenario
from sim.walking.finished import Walk
from sim.walking.walker import Walker


def walk(robot: Robot, plan: Plan, progress: Progress = silent, **changes: Any) -> Walk:
    """Walk a plan in the physics, open loop.

    Args:
        robot: Robot that the plan is for.
        plan: Flows of its equations.
        progress: Called with each stage and the finished part of it.
        **changes: Settings of a scenario that are not to have their defaults, such as
            `friction=0.5`.

    Raises:
        UsageError: If a setting is impossible, or the walk takes too many steps.
        ModelError: If the robot cannot be used.
        SimulationError: If the plan tips the robot over or makes legs collide, or the
            physics diverges.

    Example:
        >>> from models import equations, load
        >>> from planner import line, plan
        >>> from sim import walk
        >>> robot = load("hexapod")
        >>> path = line((0, 0, 0), (0.01, 0.01, 0))
        >>> walked = walk(robot, plan(equations(robot), path, segments=2), friction=0.8)
        >>> len(walked.phases)
        43
    """
    setup = prepare(scenario_of(robot, plan, **changes), robot)
    require_sound(setup, plan)
    return carry_out(Walker(setup, progress), plan)


def carry_out(walker: Walker, planned: Plan | None) -> Walk:
    """Carry out a plan open loop; without one, plan each segment from the pose reached.

    The walker is at its start; after a failure it holds what was done.
    """
    walker.stand()
    if (motion := walker.setup.motion) is not None:
        walker.play(motion)
        return walker.finish()
    if planned is None:
        return walker.finish(*replanned(walker))
    walker.go(list(planned.segments()))
    return walker.finish()


def replanned(walker: Walker) -> tuple[int, Followed]:
    """Walk segment by segment, with all feet down in between.

    Gives how many segments were scaled down to the joint range, and what feedback made
    of each.
    """
    setup, scenario = walker.setup, walker.setup.scenario
    feedback, dt = setup.feedback(), setup.limits.timestep
    random = np.random.default_rng([scenario.sense_draw, scenario.draw])
    sensor = Sensor(feedback.sensing, random)
    saturated, stops = 0, list[Stop]()
    for segment in range(scenario.segments):
        began, steps, swing = time.perf_counter(), walker.steps, walker.swing
        step, meant = next_segment(setup, feedback, segment, swing)
        walker.seconds["plan"] += time.perf_counter() - began
        saturated += step.fraction < 1
        walker.go(list(step.plan.segments()), segment, feedback.sensing.stop)
        seconds, pose = (walker.steps - steps) * dt, walker.pose
        seen, now = sensor.read(pose, seconds), walker.steps * dt
        stops.append(stop_after(feedback, segment, now, seconds, meant, seen, pose))
    return saturated, Followed(tuple(stops), feedback, setup.learns)


def next_segment(
    setup: Setup, feedback: Feedback, segment: int, swing: tuple[float, ...]
) -> tuple[Step, Array]:
    """A segment's plan from where the robot is thought to be, and the motion it means.

    The groups begin at angles `swing` [rad]; the motion is seen from there, (3,).
    """
    aim = feedback.aim(segment_target(setup, segment)) if setup.learns else None
    step = plan_segment(setup, segment, feedback.pose, swing, aim)
    legs = LegState(swing, setup.robot.card.bottom)
    require_sound_flows(setup, step.plan.segments(), legs)
    twists = twist_model(setup, setup.scenario.steered_on)
    return step, segment_ends(setup, step.plan, twists, swing)[-1]


def expected_steps(setup: Setup, planned: Plan | None) -> int:
    """Physics steps that a walk will take.

    One that is replanned is estimated from its first segment.
    """
    if setup.motion is not None:
        return round(setup.limits.hold / setup.limits.timestep) + setup.motion.steps
    segments = 1 if planned is None else setup.scenario.segments
    if planned is None:
        swing = setup.at_rest.swing
        planned = plan_segment(setup, 0, np.zeros(3), swing).plan
    schedule = scheduled(setup, planned.segments())
    holds = 2 * round(setup.limits.hold / setup.limits.timestep)
    return holds + schedule.stop * setup.scenario.segments // segments


def scenario_of(robot: Robot, plan: Plan, **changes: Any) -> Scenario:
    """The scenario that a plan of a robot carries out, with some settings changed."""
    printed = plan.elements == equations(robot, "paper").elements
    shipped = robot.is_shipped
    return Scenario(
        **{
            "name": "plan",
            "robot": robot.name if shipped else str(robot.path.resolve()),
            "fields": "paper" if printed else "lifted",
            "segments": len(plan.segment_ends),
            "path": waypoints(plan.nominal[:, :3].tolist()),
        }
        | changes
    )
