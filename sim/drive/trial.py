"""Walks beforehand: a rehearsal on stiff servos, and a trial on those of the robot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim.drive.drive import Drive, Torques
from sim.drive.feed_forward import FeedForward, smoothed
from sim.drive.rehearsal import rehearsal_of
from sim.motion.schedule import Schedule
from sim.physics.engine import Engine
from sim.preparation.setup import Setup


class Trial:
    """A second robot on servos like the first one's, without any imperfection.

    It is told what the robot would be told if there were no bands.
    """

    def __init__(self, setup: Setup) -> None:
        planned = setup.as_planned
        scenario = replace(planned.scenario, assumed_dead_band=0.0)
        planned = replace(planned, scenario=scenario)
        self._drive, self._engine = Drive(planned), Engine(planned.model)
        self._timestep = planned.limits.timestep

    def torques(self, schedule: Schedule, rehearsed: FeedForward | None) -> FeedForward:
        """Walk a schedule and return the torques that it took."""
        torques = [
            self._engine.advance(ctrl).actuator_force
            for ctrl in self._drive.commands(schedule, rehearsed)
        ]
        return smoothed(np.concatenate(torques), self._timestep)


class Beforehand:
    """The torques that the commands of a drive depend on, stretch by stretch.

    A stretch that needs more torque than a servo has is refused.
    """

    def __init__(self, setup: Setup, drive: Drive) -> None:
        self._drive = drive
        self._rehearsal = rehearsal_of(setup)
        self._trial = Trial(setup) if drive.allows_for_bands else None

    def torques(self, schedule: Schedule) -> Torques:
        """Those that commands make up for, and those that servos without bands bear."""
        made_up = None
        if self._rehearsal is not None:
            rehearsed = self._rehearsal.torques(schedule)
            self._drive.require_strength(schedule, rehearsed)
            made_up = rehearsed if self._drive.feeds_forward else None
        if self._trial is None:
            return made_up, None
        return made_up, self._trial.torques(schedule, made_up)
