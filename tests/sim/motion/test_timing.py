"""Times of commands, and ways of bodies, from formulas of their own."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, solve_ivp

from planner import Flow
from planner.planning.paths import line
from sim.motion.poses import (
    compose,
    length_up_to,
    path_deviation,
    relative,
    rotate,
    spaced_rows,
    tilt,
    trail,
)
from sim.motion.schedule import (
    LegState,
    MotionLimits,
    Phase,
    Scheduler,
    command_at,
    ramp,
    step_of,
)

DT = 0.001
LIMITS = MotionLimits(0.5, 5.0, 0.3, 0.2, 0.5, DT, ("1", "2", "3"))


@pytest.mark.parametrize(("steps", "rise"), [(300, 100), (200, 100), (250, 40), (9, 1)])
def test_the_speed_of_a_ramp_rises_and_falls_along_a_cubic(steps, rise):
    """Speed 3 s^2 - 2 s^3 of the share s of the rise; the way is its integral."""
    fine = np.linspace(0, steps, 20 * steps + 1)
    s = np.clip(np.minimum(fine, steps - fine) / rise, 0, 1)
    way = cumulative_trapezoid(3 * s**2 - 2 * s**3, fine, initial=0.0)
    found = ramp(np.arange(1, steps + 1), steps, rise)
    assert found == pytest.approx((way / way[-1])[20::20], abs=2e-3 / rise)
    assert found[-1] == 1.0


def test_a_hold_has_a_ramp_without_rise():
    assert ramp(np.arange(1, 5), 4, 0) == pytest.approx([0.25, 0.5, 0.75, 1.0])


@pytest.mark.parametrize("amount", [1e-4, 0.01, 0.07, 0.3, -0.3, 2.0])
def test_a_swing_is_as_short_as_its_bounds_let_it_be(amount):
    """One step less of rise or of cruise would break a bound."""
    steps, rise = LIMITS.swing_steps((1.0, 0.0, 0.0), amount)
    cruise = steps - 2 * rise

    def peaks(rise, cruise):
        speed = abs(amount) / ((rise + cruise) * DT)
        return speed, 1.5 * speed / (rise * DT)

    speed, acceleration = peaks(rise, cruise)
    assert speed <= 0.5 * (1 + 1e-9)
    assert acceleration <= 5.0 * (1 + 1e-9)
    if cruise > 0:
        assert speed > 0.5 * 0.97
        assert peaks(rise, cruise - 1)[0] > 0.5 * (1 - 1e-9)
    if rise > 1:
        speed, acceleration = peaks(rise - 1, cruise)
        assert speed > 0.5 or acceleration > 5.0 * (1 - 2 / rise)
    assert LIMITS.swing_steps((1.0, 0.0, 0.0), 0.0) == (0, 0)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.5, -2.0, 1.0)])
def test_the_peak_of_a_swing_is_that_of_the_farthest_group(direction):
    steps, rise = LIMITS.swing_steps(direction, -0.2)
    most = 0.2 * max(map(abs, direction))
    assert (steps, rise) == LIMITS.swing_steps((1.0, 0.0, 0.0), most)
    way = most * ramp(np.arange(1, steps + 1), steps, rise)
    fastest = np.diff(way).max() / DT
    assert LIMITS.swing_peak(direction, -0.2) == pytest.approx(fastest, rel=1e-3)
    assert LIMITS.swing_peak(direction, 0.0) == 0.0


def made(limits=LIMITS, stratum="123"):
    return Scheduler(limits, LegState((0.0, 0.1, 0.2), stratum), step=7, segment=2)


@pytest.mark.parametrize(
    ("seconds", "steps"), [(0.0, 1), (0.0012, 1), (0.0016, 2), (0.3, 300)]
)
def test_a_hold_lasts_whole_steps_and_one_at_least(seconds, steps):
    scheduler = made()
    scheduler.hold(seconds)
    (phase,) = scheduler.finish().phases
    assert (phase.kind, phase.start, phase.steps, phase.segment) == (
        "hold",
        7,
        steps,
        2,
    )
    assert phase.moving == ()
    assert phase.stop == 7 + steps


@pytest.mark.parametrize(("lasts", "steps"), [(0.2, 200), (0.0004, 2), (0.0026, 3)])
def test_a_lift_lasts_two_steps_at_least(lasts, steps):
    scheduler = made(MotionLimits(0.5, 5.0, 0.3, lasts, 0.5, DT, ("1", "2", "3")))
    scheduler.enter("13")
    (phase,) = scheduler.finish().phases
    assert (phase.kind, phase.steps, phase.amount) == ("lift", steps, 0.3)
    assert phase.direction == (0.0, 1.0, 0.0)
    assert phase.stratum == "13"


def test_groups_land_in_their_order_before_others_lift():
    scheduler = made(stratum="1")
    scheduler.enter("23")
    schedule = scheduler.finish()
    found = [(p.kind, p.moving, p.stratum, p.amount) for p in schedule.phases]
    assert found == [
        ("land", (1,), "1", -0.3),
        ("land", (2,), "12", -0.3),
        ("lift", (0,), "23", 0.3),
    ]
    assert schedule.end.stratum == "23"
    assert schedule.start == 7
    assert schedule.stop == 7 + 600
    _, lift = schedule.angles()
    assert lift[0] == pytest.approx([0.0, 0.3, 0.3], abs=1e-4)
    assert lift[-1] == pytest.approx([0.3, 0.0, 0.0])
    halfway = schedule.angles(np.array([99, 399]))[1]
    assert halfway[:, 1] == pytest.approx([0.15, 0.0])
    assert halfway[:, 2] == pytest.approx([0.3, 0.0])


def test_a_flow_swings_groups_by_their_shares_and_is_marked_with_its_field():
    scheduler = made()
    scheduler.flow(Flow("12", "g", -0.2), (1.0, -0.5, 0.0))
    schedule = scheduler.finish()
    lift, swing = schedule.phases
    assert (lift.kind, swing.kind, swing.field) == ("lift", "swing", "g")
    assert swing.moving == (0, 1)
    assert schedule.end.swing == pytest.approx((-0.2, 0.2, 0.2))
    angles, _ = schedule.angles()
    assert len(angles) == lift.steps + swing.steps
    assert angles[lift.steps - 1] == pytest.approx([0.0, 0.1, 0.2])
    assert angles[-1] == pytest.approx([-0.2, 0.2, 0.2])
    rows = np.array([0, lift.steps - 1, lift.steps, lift.steps + swing.steps - 1])
    assert schedule.phase_of(rows).tolist() == [0, 0, 1, 1]
    empty = made().finish()
    assert (empty.start, empty.stop) == (0, 0)


def test_a_phase_stands_on_its_stratum_unless_feet_are_given():
    class Robot:
        def planted(self, stratum):
            """Say what was asked."""
            return stratum

    phase = Phase("hold", "12", (0.0,), 0.0, 0, 5, 0)
    assert phase.planted(Robot()) == "12"
    feet = Phase("hold", "", (0.0,), 0.0, 0, 5, 0, feet=(True, False))
    assert feet.planted(Robot()).tolist() == [True, False]


@pytest.mark.parametrize("pace", [0.02, 0.06, 1 / 3, 1.0])
def test_a_command_is_in_force_from_the_first_step_at_or_after_its_time(pace):
    steps = np.arange(0, 200)
    found = command_at(steps, pace)
    given = step_of(np.arange(found[-1] + 1), pace)
    assert (found[given] == np.arange(found[-1] + 1)).all()
    assert (given >= np.arange(len(given)) / pace - 1e-6).all()
    assert (given < np.arange(len(given)) / pace + 1 - 1e-6).all()
    assert found[given[1:] - 1].tolist() == list(range(len(given) - 1))


def test_composing_a_relative_step_leads_to_the_other_pose():
    one, other = np.random.default_rng(0).normal(size=(2, 6, 3)) * 2
    assert compose(one, relative(one, other)) == pytest.approx(other)
    x, y = np.moveaxis(rotate(other[:, :2], one[:, 2]), -1, 0)
    turned = (other[:, 0] + 1j * other[:, 1]) * np.exp(1j * one[:, 2])
    assert (x + 1j * y) == pytest.approx(turned)


def test_a_trail_is_the_integral_of_speeds_in_the_bodys_frame():
    count = 400
    t = (np.arange(count) + 0.5) / count
    speeds = np.stack([np.cos(2 * t), 0.3 * t, 1.5 * np.sin(4 * t)], axis=1)

    def rate(s, pose):
        v = np.array([np.cos(2 * s), 0.3 * s, 1.5 * np.sin(4 * s)])
        return compose(np.array([0, 0, pose[2]]), np.array([v[0], v[1], 0]))[
            :2
        ].tolist() + [v[2]]

    end = solve_ivp(rate, (0, 1), np.zeros(3), rtol=1e-9).y[:, -1]
    found = trail(speeds / count)
    assert len(found) == count + 1
    assert found[0] == pytest.approx(np.zeros(3))
    assert found[-1] == pytest.approx(end, abs=2e-5)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, np.pi])
def test_a_body_tilts_by_the_angle_between_its_axis_and_the_vertical(angle):
    yaw = 0.7
    w, x = np.cos(angle / 2), np.sin(angle / 2)
    qpos = np.array(
        [
            9.0,
            1,
            2,
            3,
            w * np.cos(yaw),
            x * np.cos(yaw),
            x * np.sin(yaw),
            w * np.sin(yaw),
        ]
    )
    assert tilt(qpos, 1) == pytest.approx(angle)


def test_lengths_add_up_along_a_line_and_rows_are_a_spacing_apart():
    points = np.array([[1.0, 1], [4, 5], [4, 5], [4, 7], [4, 7.5], [4, 9.5]])
    assert length_up_to(points) == pytest.approx([0, 5, 5, 7, 7.5, 9.5])
    assert spaced_rows(points, 2.5).tolist() == [0, 1, 4]
    even = np.stack([np.linspace(0, 1, 101), np.zeros(101)], axis=1)
    rows = spaced_rows(even, 0.101)
    assert [0 <= b - a - 10.1 < 1 or a == 0 for a, b in pairwise(rows)].count(False) < 9
    assert rows[0] == 0
    assert len(rows) == 10


def test_departures_from_a_path_are_of_place_and_of_yaw():
    poses = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 200)
    poses[100, 1], poses[150, 2] = 0.05, -0.2
    found = path_deviation(line((0, 0, 0), (1, 0, 0)), poses)
    assert found.position == pytest.approx(0.05, abs=1e-4)
    assert found.yaw == pytest.approx(0.2, abs=1e-3)
    turning = np.linspace([0.0, 0, 0], [1.0, 0, 5.0], 200)
    wrapped = turning.copy()
    wrapped[:, 2] = (wrapped[:, 2] + np.pi) % (2 * np.pi) - np.pi
    assert path_deviation(line((0, 0, 0), (1, 0, 5.0)), wrapped).yaw < 0.01


@pytest.mark.parametrize("aside", [0.0, 0.002])
def test_a_turn_on_the_spot_departs_from_the_yaw_by_what_it_lags(aside):
    """All points of such a path are as near, and yaw tells which of them is meant."""
    share = np.linspace(0.0, 1.0, 300)
    poses = np.stack([aside * np.sin(40 * share), 0 * share, 2.0 * share], axis=1)
    path = line((0, 0, 0), (0, 0, 2.0))
    assert path_deviation(path, poses).yaw < 0.002
    poses[150, 2] += 0.1
    turned = path_deviation(path, poses)
    assert turned.yaw < 0.002  # it is early there, and no farther off the path
    poses[:, 2] *= 1.1
    assert path_deviation(path, poses).yaw == pytest.approx(0.2, abs=0.01)
    assert turned.position == pytest.approx(aside, abs=1e-4)
