"""Walks in the physics: open loop, or planned again from every pose that is reached.

What segments are likely to miss is allowed for beforehand, as `sim.feedback` has learnt
it, for which each of them brings the legs back to angle 0, not only the last one.
"""

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from models import Robot, equations
from planner import Array, Flow, Plan
from planner.planning import Step, system_table
from sim.drive.drive import Drive
from sim.drive.rehearsal import Beforehand
from sim.errors import UsageError
from sim.experiments.identification import twist_model
from sim.feedback.filter import Feedback
from sim.feedback.sensing import Sensor
from sim.feedback.stops import Followed, Stop, stop_after
from sim.logs.playing import Motion
from sim.motion.poses import seen_from
from sim.motion.prediction import inspections
from sim.motion.schedule import LegState, Schedule, Scheduler
from sim.physics.engine import Engine, State
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder
from sim.planning.open_loop import plan_segment, segment_ends, segment_target
from sim.planning.soundness import require_sound, require_sound_flows
from sim.preparation.scheduling import check_effort, schedule_flows, scheduled
from sim.preparation.setup import Setup, prepare
from sim.preparation.shared import PLAN, Cache, no_cache
from sim.progress import Progress, silent
from sim.scenarios.body_path import waypoints
from sim.scenarios.declaration import require_keys
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS
from sim.walking.finished import Stretch, Walk, laid_commands


class Walker:
    """Carries out flows in the physics, commands cached, and tracks the pose."""

    def __init__(
        self, setup: Setup, progress: Progress = silent, cache: Cache = no_cache
    ) -> None:
        self.setup = setup
        self._cache = cache
        engine = Engine(setup.model)
        sensors = Sensors(setup.model, setup.robot)
        self._recorder = Recorder(engine, sensors, setup.scenario.sample_every)
        self._drive = Drive(setup)
        self._drive.require_gentleness()
        self._beforehand = Beforehand(setup, self._drive)
        self._progress = progress
        self._stretches: list[Stretch] = []
        self._shape = setup.at_rest
        self._origin: Array | None = None
        self.seconds = {"plan": 0.0, "simulate": 0.0}

    @property
    def swing(self) -> tuple[float, ...]:
        """Commanded angle of every group [rad]."""
        return self._shape.swing

    @property
    def pose(self) -> Array:
        """Pose of the robot now, in the start frame, shape (3,)."""
        world = self.setup.pose(self._recorder.engine.state.qpos)
        return world * 0.0 if self._origin is None else seen_from(self._origin, world)

    @property
    def steps(self) -> int:
        """Number of commands carried out."""
        return self._recorder.engine.steps

    @property
    def last_states(self) -> State | None:
        """States that led to a divergence, after each of the last steps."""
        return self._recorder.engine.last

    def commands(self) -> Iterator[Array]:
        """Commands carried out so far, as those of a finished walk."""
        return laid_commands(self.setup, self._stretches, self.steps)

    def stand(self) -> None:
        """Stand still on all feet; the walk starts when the first hold ends."""
        scheduler, motion = self._scheduler(), self.setup.motion
        scheduler.hold(self.setup.limits.hold)
        still = scheduler.finish()
        if motion is not None:
            still = motion.schedule(still.start, still.stop, standing=True)
        self._play(still)
        if self._origin is None:
            self._origin = self.setup.pose(self._recorder.engine.state.qpos)
            self._recorder.walk_starts = self.steps

    def go(
        self, segments: Sequence[Iterable[Flow]], first: int = 0, stop: float = 0.0
    ) -> None:
        """Carry out consecutive segments, and stand still for the time of a stop [s].

        After the last segment of the scenario the robot stands still for a while.
        """
        count, last = self.setup.scenario.segments, first + len(segments)
        scheduler = self._scheduler()
        scheduler.segment = first
        schedule_flows(self.setup, scheduler, segments)
        if stop:
            scheduler.hold(stop)
        if last == count:
            scheduler.hold(self.setup.limits.hold)
        self._play(scheduler.finish(), share=(first / count, last / count))

    def play(self, motion: Motion) -> None:
        """Carry out joint motion that is no plan's."""
        schedule = motion.schedule(self.steps, self.steps + motion.steps)
        self._play(schedule, share=(0.0, 1.0))

    def finish(
        self, saturated_segments: int = 0, followed: Followed | None = None
    ) -> Walk:
        """The walk so far."""
        origin = np.zeros(3) if self._origin is None else self._origin
        known = self.setup, tuple(self._stretches), self._recorder.finish(), origin
        return Walk(*known, saturated_segments, self.seconds, followed)

    def _scheduler(self) -> Scheduler:
        return Scheduler(self.setup.limits, self._shape, self.steps)

    def _play(self, schedule: Schedule, share: tuple[float, float] = (0, 0)) -> None:
        if not schedule.phases:
            return
        check_effort(self.setup, schedule.stop)
        began, length = time.perf_counter(), schedule.stop - schedule.start
        torques, practised = self._beforehand.feed_forward(schedule)
        self._drive.require_reach(schedule, torques)
        self._stretches.append(Stretch(schedule, self.pose, torques, practised))
        self._shape = schedule.end
        commands = self._drive.commands(schedule, torques, practised=practised)
        pieces: Iterable[Array] = commands
        if self._cache is not no_cache and self._drive.plain:
            kind = f"commands from step {schedule.start}"
            pieces = self._cache(kind, lambda: list(commands))
        for steps in self._recorder.play(pieces, inspections(schedule)):
            done = (steps - schedule.start) / length
            self._progress("walking", share[0] + (share[1] - share[0]) * done)
        self.seconds["simulate"] += time.perf_counter() - began


def walk(robot: Robot, plan: Plan, progress: Progress = silent, **changes: Any) -> Walk:
    """Walk a plan in the physics, open loop.

    Args:
        robot: Robot that the plan is for.
        plan: Flows of its equations.
        progress: Called with each stage and the finished part of it.
        **changes: Settings of a scenario that replace their defaults, such as
            `friction=0.5`; those that the plan has settled are refused.

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
    setup = prepare(_scenario_of(robot, plan, changes), robot)
    if system_table(plan.system) != system_table(setup.equations.system):
        raise UsageError.of("foreign_plan", "sim.walk", name=robot.name)
    if (start := plan.nominal[0]).any():
        raise UsageError.of("not_at_rest", "sim.walk", start=start.tolist())
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
    """Walk segment by segment: how many were scaled down, and what feedback made."""
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
    """Physics steps that a walk will take, if replanned by its first segment."""
    if setup.motion is not None:
        return round(setup.limits.hold / setup.limits.timestep) + setup.motion.steps
    segments = 1 if planned is None else setup.scenario.segments
    if planned is None:
        planned = plan_segment(setup, 0, np.zeros(3), setup.at_rest.swing).plan
    schedule = scheduled(setup, planned.segments())
    holds = 2 * round(setup.limits.hold / setup.limits.timestep)
    return holds + schedule.stop * setup.scenario.segments // segments


SETTLED = {"path", *(k for k, s in SETTINGS.items() if s.affects <= {*PLAN})}


def _scenario_of(robot: Robot, plan: Plan, changes: dict[str, Any]) -> Scenario:
    """The scenario that a plan of a robot carries out, with some settings changed."""
    require_keys(changes, "sim.walk", (), (*SETTINGS, *SETTLED))
    for name in sorted(changes.keys() & SETTLED):
        raise UsageError.of("settled", "sim.walk", name=name)
    printed = plan.elements == equations(robot, "paper").elements
    return Scenario(
        **{
            "name": "plan",
            "robot": robot.name if robot.is_shipped else str(robot.path.absolute()),
            "fields": "paper" if printed else "lifted",
            "segments": len(plan.segment_ends),
            "path": waypoints(plan.nominal[:, :3].tolist()),
        }
        | changes,
        given=frozenset(changes),
    )
