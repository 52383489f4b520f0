"""Schedules: smooth joint commands for flows, with lift-offs, swings and touchdowns.

Phases follow one another. A group that leaves the ground is raised before anything
swings, and touches down before another group lifts off.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, sqrt
from typing import Literal

import numpy as np

from models import Robot
from planner import Array, Flow

Kind = Literal["hold", "lift", "swing", "land"]


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Bounds on every commanded motion."""

    swing_speed: float  # [rad/s]
    swing_acceleration: float  # [rad/s^2]
    lift_angle: float  # [rad]
    lift_time: float  # [s], from the ground to `lift_angle`
    hold: float  # [s], at both ends
    timestep: float  # [s]
    groups: tuple[str, ...]  # names, in the order of every array
    gains: tuple[float, ...] = ()  # largest of each group's legs; 1 where none is given

    def farthest(self, direction: Sequence[float], amount: float) -> float:
        """How far the joint turns that turns farthest in a swing [rad]."""
        turned = np.multiply(direction, self.gains or 1.0)
        return abs(amount) * float(np.abs(turned).max())

    def swing_steps(self, direction: Sequence[float], amount: float) -> tuple[int, int]:
        """Number of steps of a swing and of its acceleration, within both bounds.

        The peak of the acceleration along the cubic is 1.5 times its mean.
        """
        acceleration, dt = self.swing_acceleration, self.timestep
        farthest = self.farthest(direction, amount)
        peak = min(self.swing_speed, sqrt(farthest * acceleration / 1.5))
        rise = ceil(1.5 * peak / acceleration / dt)
        cruise = ceil(max(farthest / peak / dt - rise, 0.0)) if peak else 0
        return 2 * rise + cruise, rise

    def swing_peak(self, direction: Sequence[float], amount: float) -> float:
        """Highest speed that a joint comes to in a swing [rad/s]."""
        steps, rise = self.swing_steps(direction, amount)
        way = self.farthest(direction, amount)
        return way / ((steps - rise) * self.timestep) if steps else 0.0


@dataclass(frozen=True, slots=True)
class Phase:
    """One uninterrupted motion of one or more groups, or a hold, in whole timesteps."""

    kind: Kind
    stratum: str  # groups in contact throughout, without those that lift or land
    direction: tuple[float, ...]  # how far each group moves for one of `amount`
    amount: float  # signed change of the angle [rad]
    start: int  # first timestep
    steps: int
    segment: int
    field: str = ""
    feet: tuple[bool, ...] | None = None  # in contact, where that is no stratum's

    def planted(self, robot: Robot) -> Array:
        """Which feet are in contact throughout, shape (F,), bool."""
        return robot.planted(self.stratum) if self.feet is None else np.array(self.feet)

    @property
    def stop(self) -> int:
        """First timestep after the phase."""
        return self.start + self.steps

    @property
    def moving(self) -> tuple[int, ...]:
        """Indices of the groups that move."""
        return tuple(i for i, share in enumerate(self.direction) if share)


@dataclass(frozen=True, slots=True)
class LegState:
    """Where a schedule starts: the angle of every group, and the groups in contact."""

    swing: tuple[float, ...]  # (G,) [rad]
    stratum: str


def ramp(done: Array, steps: Array | int, rise: Array | int) -> Array:
    """A smooth transition from 0 to 1, at constant speed except near both ends.

    Over `rise` steps each, at most half of all, the speed rises and falls along a
    cubic, so the acceleration is continuous. Steps done count from 1; after the last
    one the value is exactly 1.
    """

    def covered(t: Array) -> Array:  # integral of the cubic smoothstep, t in [0, 1]
        t = np.clip(t, 0, 1)
        return t**3 - t**4 / 2

    full = np.clip(done - rise, 0, np.subtract(steps, np.multiply(2, rise)))
    end = np.maximum(rise, 1)
    ends = covered(done / end) + 0.5 - covered((steps - done) / end)
    return (full + rise * ends) / np.subtract(steps, rise)


@dataclass(frozen=True)
class Schedule:
    """Phases in time order; consecutive ones share their boundary step."""

    phases: tuple[Phase, ...]
    begin: LegState
    end: LegState
    limits: MotionLimits

    @property
    def start(self) -> int:
        """First timestep."""
        return self.phases[0].start if self.phases else 0

    @property
    def stop(self) -> int:
        """First timestep after the last phase."""
        return self.phases[-1].stop if self.phases else 0

    def angles(self, rows: Array | None = None) -> tuple[Array, Array]:
        """Commanded swing and lift of every group, shape (T, G) each [rad].

        Rows (T,) are steps, by the command applied during them, from the schedule's own
        first one, 0; all steps if not given.
        """
        if rows is None:
            rows = np.arange(self.stop - self.start)
        phase = self.phase_of(rows)
        starts, steps, rise = self._timing[:, phase]
        way = ramp(rows + self.start - starts + 1.0, steps, rise)[:, None]
        swing, lift = (
            begin[phase] + way * change[phase] for begin, change in self.trajectories
        )
        return swing, lift

    def targets(self, robot: Robot, rows: Array) -> Mapping[str, Array]:
        """Commanded angle of each joint that moves, by its name, shape (T,) [rad]."""
        return robot.targets(*self.angles(rows))

    def phase_of(self, rows: Array) -> Array:
        """Index of the phase that each of the schedule's steps lies in, shape (T,)."""
        return np.searchsorted(self._timing[0] - self.start, rows, side="right") - 1

    @cached_property
    def _timing(self) -> Array:
        """First step, number of steps and rise of every phase, shape (3, phases)."""
        timing = []
        for phase in self.phases:
            rise = 0 if phase.kind == "hold" else phase.steps // 2
            if phase.kind == "swing":
                _, rise = self.limits.swing_steps(phase.direction, phase.amount)
            timing.append((phase.start, phase.steps, rise))
        return np.array(timing, dtype=int).reshape(-1, 3).T

    @cached_property
    def trajectories(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Trajectories of the swing and of the lift angles, phase by phase.

        Each is the angle of every group as a phase begins and its change during the
        phase, shape (phases, G) [rad].
        """
        begin, limits = self.begin, self.limits
        moves = [np.multiply(p.direction, p.amount) for p in self.phases]
        moved = np.array(moves).reshape(-1, len(begin.swing))
        swings = np.array([p.kind == "swing" for p in self.phases], bool)[:, None]
        raised = np.array([g not in begin.stratum for g in limits.groups])
        swing = _trajectory(np.array(begin.swing), np.where(swings, moved, 0.0))
        lift = _trajectory(raised * limits.lift_angle, np.where(swings, 0.0, moved))
        return swing, lift


def _trajectory(begin: Array, changes: Array) -> tuple[Array, Array]:
    """Angles before each of some changes, and the changes, shape (phases, G) each."""
    return np.cumsum(np.vstack([begin, changes]), axis=0)[:-1], changes


class Scheduler:
    """Builds a schedule phase by phase, keeping track of angles and contacts."""

    def __init__(
        self, limits: MotionLimits, begin: LegState, step: int = 0, segment: int = 0
    ) -> None:
        self._limits, self._begin, self._step = limits, begin, step
        self._swing, self._stratum = list(begin.swing), begin.stratum
        self._phases: list[Phase] = []
        self.segment = segment

    def finish(self) -> Schedule:
        """The schedule of all phases so far."""
        end = LegState(tuple(self._swing), self._stratum)
        return Schedule(tuple(self._phases), self._begin, end, self._limits)

    def hold(self, seconds: float) -> None:
        """Stand still."""
        still = (0.0,) * len(self._limits.groups)
        self._lay("hold", still, 0.0, max(round(seconds / self._limits.timestep), 1))

    def flow(self, flow: Flow, direction: tuple[float, ...]) -> None:
        """Enter the flow's stratum and swing each group by its share a unit of time."""
        self.enter(flow.stratum)
        steps, _ = self._limits.swing_steps(direction, flow.duration)
        pairs = zip(self._swing, direction, strict=True)
        self._swing = [angle + flow.duration * share for angle, share in pairs]
        self._lay("swing", direction, flow.duration, steps, flow.field)

    def enter(self, stratum: str) -> None:
        """Put down the groups that the stratum stands on, then lift the others."""
        groups = self._limits.groups
        for group in [g for g in groups if g in stratum and g not in self._stratum]:
            self._move("land", group, -self._limits.lift_angle)
            self._stratum = "".join(g for g in groups if g in self._stratum + group)
        for group in [g for g in self._stratum if g not in stratum]:
            self._stratum = self._stratum.replace(group, "")
            self._move("lift", group, self._limits.lift_angle)

    def _move(self, kind: Kind, group: str, amount: float) -> None:
        steps = max(round(self._limits.lift_time / self._limits.timestep), 2)
        only = tuple(float(g == group) for g in self._limits.groups)
        self._lay(kind, only, amount, steps)

    def _lay(
        self,
        kind: Kind,
        direction: tuple[float, ...],
        amount: float,
        steps: int,
        field: str = "",
    ) -> None:
        if steps:
            when = self._step, steps, self.segment
            phase = Phase(kind, self._stratum, direction, amount, *when, field)
            self._phases.append(phase)
            self._step += steps


SLACK = 1e-9  # of a number of a command or step, for rounding


def command_at(step: Array, pace: float) -> Array:
    """Numbers of the commands in force during steps, at a pace of commands a step.

    Servos get command k at the first physics step at or after k / pace.
    """
    return np.floor(step * pace + SLACK).astype(int)


def step_of(command: Array, pace: float) -> Array:
    """Physics steps at which commands of these numbers are given."""
    return np.ceil(command / pace - SLACK).astype(int)
