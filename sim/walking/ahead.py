"""A walk before it is walked: its stretches, and where it is predicted to end."""

from __future__ import annotations

import numpy as np

from planner import Array, Plan
from sim.compliant.prediction import Leg, course_of, phases_of
from sim.drive.drive import Drive
from sim.drive.rehearsal import rehearsal_of
from sim.motion.schedule import Scheduler
from sim.preparation.scheduling import schedule_flows
from sim.preparation.setup import Setup
from sim.walking.finished import Stretch, laid_commands


def laid_out(setup: Setup, planned: Plan) -> list[Stretch]:
    """The stretches that `Walker` will carry out of an open-loop plan."""
    standing = Scheduler(setup.limits, setup.at_rest)
    standing.hold(setup.limits.hold)
    first = standing.finish()
    walking = Scheduler(setup.limits, first.end, first.stop)
    schedule_flows(setup, walking, list(planned.segments()))
    walking.hold(setup.limits.hold)
    drive, rehearsal = Drive(setup), rehearsal_of(setup)
    stretches = []
    for schedule in (first, walking.finish()):
        torques = None
        if rehearsal is not None and drive.feeds_forward:
            torques = rehearsal.torques(schedule)
        stretches.append(Stretch(schedule, np.zeros(3), torques))
    return stretches


class Ahead:
    """Sees ahead where plans of one robot in one world end.

    Phases that plans have in common are computed once.
    """

    def __init__(self, setup: Setup) -> None:
        self._told = setup.as_told
        self._phases = phases_of(self._told)

    def end(self, setup: Setup, planned: Plan) -> Array:
        """Pose at the end of a plan in the start frame, (3,), yaw not wrapped.

        Raises MeasurementError where the robot tips over, or no equilibrium is found.
        """
        stretches = laid_out(setup, planned)
        legs = [Leg(stretch.schedule, stretch.pose) for stretch in stretches]
        rows = laid_commands(self._told, stretches, stretches[-1].schedule.stop)
        course = course_of(self._told, self._phases, legs, rows)
        return self._phases.follow(course).pose[-1]
