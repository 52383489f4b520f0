"""Walk a plan in the physics: open loop, or planned again from every pose reached.

Produces a `Walk`, the raw material of `sim.evaluate`; judges nothing itself.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.flows import Flow
from planner.plan import Plan, plan
from planner.replan import plan_step
from sim.measure import Sensors
from sim.physics import Engine
from sim.poses import nearest_turn, seen_from
from sim.recording import Progress, Recorder, Recording
from sim.schedule import Phase, Schedule, Scheduler
from sim.setup import Setup

Array = np.ndarray


@dataclass(frozen=True)
class Stretch:
    """Commands laid in one go, and the pose from which they were predicted."""

    schedule: Schedule
    pose: Array  # in the start frame, (3,)


@dataclass(frozen=True)
class Walk:
    """A finished walk."""

    setup: Setup
    stretches: tuple[Stretch, ...]
    recording: Recording
    origin: Array  # start pose in the world, (3,)
    saturated_segments: int
    timing: dict[str, float]  # [s]

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """All phases in time order."""
        return tuple(p for stretch in self.stretches for p in stretch.schedule.phases)

    @property
    def duration(self) -> float:
        """From the start of the walk to its end [s]."""
        return (self.phases[-1].stop - self.starts) * self.setup.limits.timestep

    @property
    def starts(self) -> int:
        """Number of steps of the first hold, after which the walk begins."""
        return self.stretches[0].schedule.stop


class Walker:
    """Executes flows and keeps track of where the robot is."""

    def __init__(self, setup: Setup, progress: Progress | None = None) -> None:
        self.setup = setup
        engine = Engine(setup.model)
        sensors = Sensors(setup.model, setup.robot)
        self._recorder = Recorder(
            engine, sensors, setup.scenario.sample_every, progress
        )
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
        world = self.setup.pose(self._recorder.engine.qpos)
        return world * 0.0 if self._origin is None else seen_from(self._origin, world)

    def stand(self) -> None:
        """Hold still on all feet; the end of the first hold is the start of the walk."""
        scheduler = self._scheduler()
        scheduler.hold(self.setup.limits.hold)
        self._play(scheduler.finish())
        if self._origin is None:
            self._origin = self.setup.pose(self._recorder.engine.qpos)

    def go(
        self, segments: Iterable[Iterable[Flow]], first: int = 0, rest: float = 0.0
    ) -> None:
        """Carry out the flows of consecutive segments, then stand still on all feet.

        Args:
            segments: Flows of each segment.
            first: Number of the first of them.
            rest: How long to stand at the end [s].
        """
        scheduler = self._scheduler()
        scheduler.segment = first
        lay(self.setup, scheduler, segments)
        scheduler.hold(rest)
        self._play(scheduler.finish())

    def finish(self, saturated_segments: int = 0) -> Walk:
        """The walk so far."""
        origin = np.zeros(3) if self._origin is None else self._origin
        return Walk(
            setup=self.setup,
            stretches=tuple(self._stretches),
            recording=self._recorder.finish(),
            origin=origin,
            saturated_segments=saturated_segments,
            timing=self.seconds,
        )

    def _scheduler(self) -> Scheduler:
        return Scheduler(self.setup.limits, self._shape, self._recorder.engine.steps)

    def _play(self, schedule: Schedule) -> None:
        ctrl = self.setup.channels.ctrl(*schedule.angles())
        self._stretches.append(Stretch(schedule, self.pose))
        self._shape = schedule.end
        began = time.perf_counter()
        self._recorder.play(ctrl)
        self.seconds["simulate"] += time.perf_counter() - began


def lay(setup: Setup, scheduler: Scheduler, segments: Iterable[Iterable[Flow]]) -> None:
    """Lay the flows of consecutive segments, and put all feet down at their end."""
    for number, flows in enumerate(segments, start=scheduler.segment):
        scheduler.segment = number
        for flow in flows:
            scheduler.flow(flow, setup.equations.swings[flow.field])
    scheduler.enter(setup.robot.card.bottom)


def walk(setup: Setup, progress: Progress | None = None) -> Walk:
    """Walk the scenario, open loop or planned again at every segment.

    Raises:
        PlannerError: If there is no plan, or it leaves the joint range.
        SimulationError: If the physics diverges.
    """
    walker = Walker(setup, progress)
    follow = _replanned if setup.scenario.replan else _open_loop
    return walker.finish(follow(walker))


def plan_open_loop(setup: Setup) -> Plan:
    """One plan for the whole path."""
    return plan(
        setup.extended,
        setup.nominal(),
        setup.scenario.segments,
        stance=setup.stance,
        limits=setup.swing_limits,
    )


def _open_loop(walker: Walker) -> int:
    """Carry one plan out blindly."""
    setup = walker.setup
    began = time.perf_counter()
    planned = plan_open_loop(setup)
    walker.seconds["plan"] += time.perf_counter() - began
    walker.stand()
    walker.go(planned.segments(), rest=setup.limits.hold)
    return 0


def _replanned(walker: Walker) -> int:
    """Every segment planned from the pose reached, read with all feet down."""
    setup, segments = walker.setup, walker.setup.scenario.segments
    saturated = 0
    walker.stand()
    for segment in range(segments):
        last = segment == segments - 1
        began = time.perf_counter()
        target = setup.nominal()((segment + 1) / segments)
        pose = walker.pose
        pose[2] = nearest_turn(pose[2], to=target[2])
        step = plan_step(
            setup.extended,
            setup.state(pose, walker.swing),
            target,
            setup.execution(finish=last),
        )
        saturated += step.fraction < 1
        walker.seconds["plan"] += time.perf_counter() - began
        rest = setup.limits.hold if last else 0.0
        walker.go(step.plan.segments(), first=segment, rest=rest)
    return saturated
