"""Rehearsals: the torques that a walk takes, walked or predicted beforehand.

Either is made on very stiff servos and without the imperfections of the walking robot,
stretch by stretch.
"""

from dataclasses import replace

import numpy as np

from planner import Array
from sim.compliant.prediction import Leg, course_of, phases_of
from sim.drive.drive import Allowed, Drive
from sim.drive.feed_forward import FeedForward, smoothed, stiffened
from sim.drive.practice import Practice
from sim.motion.schedule import Schedule
from sim.physics.engine import Engine
from sim.preparation.setup import Setup


class Rehearsal:
    """A second robot that walks every stretch beforehand."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup.as_planned
        self._engine = Engine(stiffened(self._setup))

    def torques(self, schedule: Schedule) -> FeedForward:
        """Walk a schedule and return the torques that it took."""
        torques = [
            self._engine.advance(ctrl).actuator_force
            for ctrl in self._setup.commands(schedule)
        ]
        return smoothed(np.concatenate(torques), self._setup.limits.timestep)


class Foreseen:
    """The compliant prediction of every stretch, in place of a rehearsal."""

    def __init__(self, setup: Setup) -> None:
        planned = setup.as_planned
        self._setup = replace(
            planned, model=stiffened(planned), servo=replace(planned.servo, rate=0.0)
        )
        self._phases = phases_of(self._setup)
        self._legs: list[Leg] = []
        self._rows: list[Array] = []

    def torques(self, schedule: Schedule) -> FeedForward:
        """Predict a schedule after those before it and return the torques it takes."""
        self._legs.append(Leg(schedule, np.zeros(3)))
        self._rows += list(self._setup.commands(schedule))
        course = course_of(self._setup, self._phases, self._legs, self._rows)
        steps = 1 + np.arange(schedule.start, schedule.stop)
        dt, anatomy = self._setup.limits.timestep, self._phases.mechanics.anatomy
        found = self._phases.follow(course).at(steps * dt).torque
        torques = np.zeros((len(steps), self._setup.model.nu))
        real = anatomy.axis.any(axis=-1)
        torques[:, anatomy.actuator[real]] = found[:, real]
        return smoothed(torques, dt)


def rehearsal_of(setup: Setup) -> Rehearsal | Foreseen | None:
    """What knows the torques of a walk beforehand; None where nobody asks."""
    if not Drive(setup).rehearsed:
        return None
    predicted = setup.servo.feed_forward == "predicted"
    return Foreseen(setup) if predicted else Rehearsal(setup)


class Beforehand:
    """What commands depend on, stretch by stretch; too much torque is refused."""

    def __init__(self, setup: Setup, drive: Drive) -> None:
        self._drive = drive
        self._rehearsal = rehearsal_of(setup)
        self._practice = Practice(setup) if drive.practises else None

    def feed_forward(self, schedule: Schedule) -> Allowed:
        """Torques that commands make up for, and what was practised."""
        made_up = None
        if self._rehearsal is not None:
            rehearsed = self._rehearsal.torques(schedule)
            self._drive.require_strength(schedule, rehearsed)
            made_up = rehearsed if self._drive.feeds_forward else None
        if self._practice is None:
            return made_up, None
        return made_up, self._practice.shifts(schedule, made_up)
