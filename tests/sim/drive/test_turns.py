"""Turns of practice: which of them is taken, and what is added from turn to turn."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.drive.feed_forward import FeedForward
from sim.drive.rehearsal import Practice

PART = 0.7  # of what was missed, that is added after a turn
TURNS = 8  # of practice, at most: they need not converge, and the best is taken
WELL_MET = 0.002  # of the reach, that a turn may miss the end by for practice to end

REACH, GOAL = 0.2, np.array([1.0, 2.0, 0.5])


class Robot:
    """A robot that ends off its goal by known steps, and bends by known angles."""

    def __init__(self, offs, missed):
        self.offs, self.missed, self.shifts = list(offs), missed, []
        self.setup = SimpleNamespace(kinematics=SimpleNamespace(reach=REACH))
        self.drive = SimpleNamespace(turn=0)
        self.engine = SimpleNamespace(moment=0, rewind=lambda moment: None)

    def walk(self, schedule, made_up, shifts):
        """Note the shifts, and end off the goal."""
        self.shifts.append(None if shifts is None else shifts.values.copy())
        off = self.offs.pop(0)
        own = np.zeros((1, 2)) if shifts is None else shifts.values - self.missed
        return FeedForward(own, 1), GOAL + off


def practised(offs, missed=(0.01, -0.03), width=0.05):
    tight, loose = Robot([np.zeros(3)], 0.0), Robot(offs, np.array([missed]))
    practice = Practice.__new__(Practice)
    practice._tight, practice._loose = tight, loose
    practice._width, practice._shift = np.full(2, width), np.zeros(2)
    return practice.shifts(None, None), loose.shifts


def off(x=0.0, y=0.0, yaw=0.0):
    return np.array([x, y, yaw])


def test_a_part_of_what_is_missed_is_added_after_each_turn():
    bad = [off(0.1)] * TURNS
    _, shifts = practised(bad)
    assert len(shifts) == TURNS
    assert shifts[0] == pytest.approx(np.zeros((1, 2)))
    assert shifts[1] == pytest.approx(PART * np.array([[0.01, -0.03]]))
    assert shifts[2] == pytest.approx(PART * (2 - PART) * np.array([[0.01, -0.03]]))


def test_shifts_are_no_wider_than_the_slack():
    _, shifts = practised([off(0.1)] * TURNS, missed=(1.0, -1.0), width=0.02)
    assert shifts[1] == pytest.approx(np.array([[0.02, -0.02]]))


@pytest.mark.parametrize(
    ("better", "worse"),
    [
        (off(yaw=0.1), off(x=0.03)),  # yaw counts at the reach
        (off(yaw=-0.1), off(x=0.03)),
        (off(x=0.01, y=0.01), off(yaw=0.1)),
        (off(yaw=2 * np.pi + 0.01), off(x=0.02)),
    ],
)
def test_the_turn_that_ends_nearest_is_taken(better, worse):
    found, shifts = practised([off(), worse, better, *[worse] * TURNS])
    assert found.values == pytest.approx(shifts[2])
    assert (found.values != shifts[1]).any()


@pytest.mark.parametrize(("share", "turns"), [(0.9, 3), (1.1, TURNS)])
def test_practice_ends_where_the_end_is_well_met_but_not_without_a_shift(share, turns):
    near = off(x=share * WELL_MET * REACH)
    _, shifts = practised([off(), off(0.1), near, *[off(0.1)] * TURNS])
    assert len(shifts) == turns
