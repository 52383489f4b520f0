"""A walk as it has become, and where a plan is predicted to end before it is walked."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array, Plan
from sim.compliant.prediction import Leg, course_of, phases_of
from sim.drive.drive import Drive
from sim.drive.feed_forward import FeedForward
from sim.drive.rehearsal import Beforehand
from sim.feedback.stops import Followed
from sim.motion.schedule import Phase, Scheduler
from sim.physics.recording import Recording
from sim.preparation.scheduling import schedule_flows
from sim.preparation.setup import Setup


@dataclass(frozen=True, eq=False)
class Stretch(Leg):
    """A part of the walk, which begins at a pose in the start frame."""

    torques: FeedForward | None = None  # that the commands make up for
    practised: FeedForward | None = None  # that the commands add, where there is slack


@dataclass(frozen=True)
class Walk:
    """A finished walk.

    Example:
        >>> from sim import load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> walk = simulate(load_scenario("line", short)).evaluation.walk
        >>> walk.phases[0].kind
        'hold'
    """

    setup: Setup
    stretches: tuple[Stretch, ...]
    recording: Recording
    origin: Array  # start pose in the world, (3,)
    saturated_segments: int
    seconds: dict[str, float]  # spent on replanning and on simulating
    followed: Followed | None = None  # if segments were planned from where it stood

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """All phases in time order."""
        return tuple(p for stretch in self.stretches for p in stretch.schedule.phases)

    @property
    def duration(self) -> float:
        """From the start of the walk to its end [s]."""
        return (self.phases[-1].stop - self.starts) * self.setup.limits.timestep

    @property
    def distance(self) -> float:
        """Way of the ideal body centre, back and forth [m]."""
        return way_of(self.setup, self.phases)

    @property
    def starts(self) -> int:
        """Number of steps of the first hold, after which the walk begins."""
        return self.stretches[0].schedule.stop

    def commands(self) -> Iterator[Array]:
        """Commands carried out, computed from the schedules, shape (n, nu) each."""
        return laid_commands(self.setup, self.stretches, self.steps)

    @property
    def steps(self) -> int:
        """Number of commands carried out."""
        return self.recording.steps


def laid_commands(
    setup: Setup, stretches: Iterable[Stretch], steps: int
) -> Iterator[Array]:
    """The commands of stretches, as many as there were steps, shape (n, nu) each."""
    drive = Drive(setup)
    for stretch in stretches:
        schedule = stretch.schedule
        done = min(schedule.stop, steps) - schedule.start
        yield from drive.commands(schedule, stretch.torques, done, stretch.practised)


def way_of(setup: Setup, phases: Iterable[Phase]) -> float:
    """Way of the ideal body centre in some phases, back and forth [m]."""
    swings = [phase for phase in phases if phase.kind == "swing" and phase.field]
    return float(sum(setup.equations.stride(p.field) * abs(p.amount) for p in swings))


def laid_out(setup: Setup, planned: Plan) -> list[Stretch]:
    """The stretches that `Walker` will carry out of an open-loop plan."""
    standing = Scheduler(setup.limits, setup.at_rest)
    standing.hold(setup.limits.hold)
    first = standing.finish()
    walking = Scheduler(setup.limits, first.end, first.stop)
    schedule_flows(setup, walking, list(planned.segments()))
    walking.hold(setup.limits.hold)
    both, beforehand = (first, walking.finish()), Beforehand(setup, Drive(setup))
    return [Stretch(s, np.zeros(3), *beforehand.feed_forward(s)) for s in both]


class Ahead:
    """Sees ahead where plans of a robot end; phases in common are computed once."""

    def __init__(self, setup: Setup) -> None:
        self._known = setup.as_known
        self._phases = phases_of(self._known)

    def end(self, setup: Setup, planned: Plan) -> Array:
        """Pose at the end of a plan in the start frame, (3,), yaw not wrapped.

        Raises MeasurementError where the robot tips over, or no equilibrium is found.
        """
        stretches = laid_out(setup, planned)
        rows = laid_commands(self._known, stretches, stretches[-1].schedule.stop)
        course = course_of(self._known, self._phases, stretches, rows)
        return self._phases.follow(course).pose[-1]
