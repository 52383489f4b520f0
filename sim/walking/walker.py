"""A walker: carries out flows in the physics, stretch by stretch."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from planner import Array, Flow
from sim.drive.drive import Drive
from sim.drive.feed_forward import FeedForward
from sim.drive.rehearsal import Beforehand
from sim.feedback.stops import Followed
from sim.logs.playing import Motion
from sim.motion.poses import seen_from
from sim.motion.prediction import inspections
from sim.motion.schedule import Schedule, Scheduler
from sim.physics.engine import Engine, State
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder
from sim.preparation.scheduling import check_effort, schedule_flows
from sim.preparation.setup import Setup
from sim.preparation.shared import Cache, no_cache
from sim.progress import Progress, silent
from sim.walking.finished import Stretch, Walk, laid_commands


class Walker:
    """Carries out flows in the physics and keeps track of the robot's pose.

    The cache stores commands for walks that have the same.
    """

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
        """Carry out the flows of consecutive segments, the first of that number.

        All feet are put down, and the robot stands still for the time of a stop [s].
        After the last segment of the scenario it stands still for a while.
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
        return Walk(
            setup=self.setup,
            stretches=tuple(self._stretches),
            recording=self._recorder.finish(),
            origin=origin,
            saturated_segments=saturated_segments,
            followed=followed,
            seconds=self.seconds,
        )

    def _scheduler(self) -> Scheduler:
        return Scheduler(self.setup.limits, self._shape, self.steps)

    def _play(
        self, schedule: Schedule, share: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        if not schedule.phases:
            return
        check_effort(self.setup, schedule.stop)
        began, length = time.perf_counter(), schedule.stop - schedule.start
        torques, practised = self._beforehand.leads(schedule)
        self._drive.require_reach(schedule, torques)
        self._stretches.append(Stretch(schedule, self.pose, torques, practised))
        self._shape = schedule.end
        pieces = self._commands(schedule, torques, practised)
        for steps in self._recorder.play(pieces, inspections(schedule)):
            done = (steps - schedule.start) / length
            self._progress("walking", share[0] + (share[1] - share[0]) * done)
        self.seconds["simulate"] += time.perf_counter() - began

    def _commands(
        self,
        schedule: Schedule,
        torques: FeedForward | None,
        practised: FeedForward | None,
    ) -> Iterable[Array]:
        """Commands of a stretch, which walks with the same schedule have in common."""
        pieces = self._drive.commands(schedule, torques, practised=practised)
        if self._cache is no_cache or not self._drive.plain:
            return pieces
        return self._cache(f"commands from step {schedule.start}", lambda: list(pieces))
