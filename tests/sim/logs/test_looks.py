"""Moments at which the feet of a played log are looked at, and phases between them."""

import numpy as np
import pytest

from models import load
from sim.logs.log import Log
from sim.logs.playing import LOOKS_APART, MOST_LOOKS, Motion
from sim.motion.schedule import MotionLimits

LIMITS = MotionLimits(0.5, 5.0, 0.3, 0.3, 0.5, 0.001, ("1", "2"))


def still(duration, robot=None):
    log = Log(np.array([0.0, duration]), ("lift_1",), np.zeros((2, 1)))
    return Motion(log, robot, LIMITS)


@pytest.mark.parametrize(("duration", "count"), [(1.0, 201), (0.012, 4), (0.001, 2)])
def test_feet_are_looked_at_every_five_milliseconds(duration, count):
    time = still(duration).time
    assert len(time) == count
    assert (time[0], time[-1]) == (0.0, duration)
    assert np.diff(time).max() <= 0.005 + 1e-12
    assert LOOKS_APART == 0.005


def test_long_logs_are_looked_at_twenty_thousand_times():
    assert len(still(600.0).time) == 20_001
    assert MOST_LOOKS == 20_000


@pytest.mark.parametrize("duration", [0.1, 0.1004, 0.1006])
def test_a_log_takes_the_steps_from_its_first_row_to_its_last(duration):
    assert still(duration).steps == round(duration * 1000) + 1


def test_a_robot_that_stands_still_has_one_phase_on_all_feet():
    robot = load("hexapod")
    motion = still(0.2, robot)
    schedule = motion.schedule(100, 100 + motion.steps)
    assert schedule.start == 100
    assert schedule.stop == 100 + motion.steps
    assert all(phase.planted(robot).all() for phase in schedule.phases)
    held = motion.schedule(0, 50, standing=True)
    (phase,) = held.phases
    assert (phase.kind, phase.start, phase.stop) == ("hold", 0, 50)
    assert motion.contact.all()
    assert (motion.margin > 0.05).all()
