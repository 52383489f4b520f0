"""Robots march through increments that are equilibria, or not at all."""

import numpy as np
import pytest

from models import MeasurementError
from sim.compliant import increment
from sim.compliant.equilibrium import Found, equilibrium
from sim.compliant.march import MOST_FAILED, march
from tests.equilibria import require_equilibrium
from tests.planned import course


@pytest.fixture(scope="module")
def short():
    return course(servo_stiffness=50.0)


def marched(short, upto, **changes):
    _, phases, way, _ = short
    one = np.zeros(1)
    return march(phases.mechanics, phases.robots, way.commands, one, one + upto, one)


def test_a_standing_robot_bears_its_weight_and_stays(short):
    (track, *_), weight = marched(short, 0.4), short[1].robots.weight[0]
    assert track.load[1:].sum(axis=1)[-1] == pytest.approx(weight, rel=1e-4)
    assert np.abs(track.place[-1, :2]).max() < 1e-5


def test_a_robot_is_stood_up_with_its_lowest_points_on_the_floor(short):
    """Rounding is of the size of the robot, 0.1 m."""
    _, phases, way, _ = short
    rows, yaw = way.commands.rows[:1], np.zeros(1)
    for floor in (0.0, 0.3):
        mechanics = increment.Mechanics(phases.mechanics.anatomy, floor)
        done = mechanics.standing(phases.robots, rows, yaw)
        assert done.state.gap.min() == pytest.approx(0.0, abs=1e-15)
        points = done.state.place[:, 2, None, None] + done.arm[..., 2]
        assert done.state.gap == pytest.approx(points - floor, abs=1e-15)


def test_increments_end_where_phases_do(short):
    (track, *_), ends = marched(short, 3.0), short[2].spans[:, 1] * 0.001
    for end in ends[ends <= 3.0]:
        assert np.abs(track.time - end).min() < 1e-9


def test_no_increment_is_accepted_that_is_no_equilibrium(short, monkeypatch):
    def failing(*problem):
        found = equilibrium(*problem)
        found.error[:] = 2.0
        return found

    monkeypatch.setattr(increment, "equilibrium", failing)
    track, ended, _ = marched(short, 0.4)
    assert ended[0] == 0.0
    assert len(track.time) == 1
    with pytest.raises(MeasurementError, match=r"finds no equilibrium at 0\.00 s"):
        short[1].follow(short[2])


def test_a_robot_that_goes_on_in_tiny_increments_alone_ends(short, monkeypatch):
    """As some do that rattle in their backlash, for hours; others recover."""
    lengths, every = [], [10**9]
    whole = increment.Mechanics.increment

    def failing(self, robots, state, begin, end, h):
        lengths.extend(h)
        done = whole(self, robots, state, begin, end, h)
        tried = sum(length > 1e-3 for length in lengths)
        recovers = (h > 1e-3) & (tried % every[0] == 0)
        return done._replace(holds=done.holds & ((h < 1e-4) | recovers))

    monkeypatch.setattr(increment.Mechanics, "increment", failing)
    _, ended, tipped = marched(short, 0.4)
    assert (
        MOST_FAILED < len(lengths) < 2 * MOST_FAILED
    )  # a quarter of them are accepted
    assert 0 < ended[0] < 0.4
    assert not tipped[0]
    lengths.clear()
    every[0] = 10
    _, ended, _ = marched(short, 0.02)
    assert len(lengths) > 2 * MOST_FAILED
    assert np.isinf(ended[0])


def test_every_accepted_increment_of_a_walk_is_an_equilibrium(short, monkeypatch):
    """Through lift-offs, strokes and touchdowns, checked in newtons and metres."""
    slid = []

    def checked(contact, twist, force, give=None):
        found = equilibrium(contact, twist, force, give)
        own = np.flatnonzero(found.holds)
        part = Found(*(values[own] for values in found))
        slid.append(len(own) and require_equilibrium(contact.take(own), part))
        return found

    monkeypatch.setattr(increment, "equilibrium", checked)
    track, *_ = marched(short, 6.0)
    assert len(track.time) > 300
    assert sum(slid) > 10


def test_an_equilibrium_is_found_on_both_sides_of_backlash(monkeypatch):
    """No increment has to be repeated for want of one: in 1.5 s it takes some 100."""
    lanes = []

    def counted(*problem):
        found = equilibrium(*problem)
        lanes.extend(found.holds)
        return found

    monkeypatch.setattr(increment, "equilibrium", counted)
    marched(course(backlash=0.005), 1.5)
    assert len(lanes) > 80
    assert all(lanes)


def test_a_leg_in_the_air_follows_its_servo_exactly(short):
    """A spring and a damper under its own weight: one increment is as good as four."""
    _, phases, way, _ = short
    mechanics, robot = phases.mechanics, phases.robots
    state = mechanics.standing(robot, way.commands.rows[:1], np.zeros(1)).state
    high = increment.State(**{**vars(state), "gap": state.gap + 1.0})
    begin, end, h = (
        way.commands.rows[:1],
        way.commands.rows[:1] + 0.01,
        np.full(1, 0.02),
    )
    falling = mechanics.increment(robot, high, begin, end, h)
    quarter = high
    for k in range(4):
        low, up = begin + 0.0025 * k, begin + 0.0025 * (k + 1)
        part = mechanics.increment(robot, quarter, low, up, h / 4)
        quarter = increment.State(**{**vars(part.state), "gap": state.gap + 1.0})
    # what is left is the weight's lever, which changes by 1 % of itself on the way
    assert np.abs(falling.state.angles - quarter.angles).max() < 2e-6


def test_the_height_of_a_floor_changes_nothing_above_it(short):
    _, phases, way, _ = short
    robot, rows, h = phases.robots, way.commands.rows[:1], np.full(1, 0.02)
    ends = []
    for floor in (0.0, 0.3):
        mechanics = increment.Mechanics(phases.mechanics.anatomy, floor)
        state = mechanics.standing(robot, rows, np.zeros(1)).state
        found = mechanics.increment(robot, state, rows, rows + 0.01, h)
        assert found.holds.all()
        ends.append((found.state.place - [0, 0, floor], found.state.gap, found.arm))
    for one, other in zip(*ends, strict=True):
        assert one == pytest.approx(other, abs=1e-9)
