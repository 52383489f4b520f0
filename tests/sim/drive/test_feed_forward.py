"""Torques made up for: how they are smoothed, read, and held against servos."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from models.description import actuators_driving
from sim.drive import rehearsal
from sim.drive.drive import LEAST_FRICTION, Drive, _needed, zero_offsets
from sim.drive.feed_forward import (
    GIVES,
    FeedForward,
    carried_torque,
    smoothed,
    stiffened,
)
from sim.drive.rehearsal import Foreseen, _half_counts
from sim.errors import SimulationError, UsageError
from sim.motion.schedule import Scheduler
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


def test_between_knots_values_lie_on_a_line_and_beyond_they_stay():
    given = FeedForward(np.array([[1.0], [3.0], [2.0]]), spacing=4)
    rows = np.array([0, 1, 4, 6, 8, 9, 100])
    assert given.at(rows)[:, 0] == pytest.approx([1.0, 1.5, 3.0, 2.5, 2.0, 2.0, 2.0])
    one = FeedForward(np.array([[7.0, 8.0]]), spacing=4)
    assert one.at(np.array([0, 5])).tolist() == [[7.0, 8.0]] * 2


@pytest.mark.parametrize(
    ("timestep", "spacing"), [(0.001, 5), (0.002, 2), (0.0005, 10), (0.02, 1)]
)
def test_values_are_averaged_over_50_ms_every_5_ms(timestep, spacing):
    """A jump becomes a ramp as long, in the middle of which the jump was."""
    steps = round(1.0 / timestep)
    jump = (np.arange(steps) >= steps // 2).astype(float)[:, None]
    found = smoothed(jump, timestep)
    assert found.spacing == spacing
    assert len(found.values) == -(-steps // spacing)
    rows = found.at(np.arange(steps))[:, 0]
    ramp = np.flatnonzero((rows > 1e-9) & (rows < 1 - 1e-9))
    if timestep < 0.01:
        assert len(ramp) * timestep == pytest.approx(0.05, abs=3 * spacing * timestep)
    assert rows[ramp].mean() == pytest.approx(0.5, abs=0.05) if len(ramp) else True
    still = smoothed(np.full((steps, 2), 3.0), timestep)
    assert still.values == pytest.approx(np.full_like(still.values, 3.0))


def test_the_whole_weight_is_carried_at_the_end_of_the_longest_leg(setup):
    """A radian of a swing leads a foot along an arc as long as its leg."""
    kinematics, robot = setup.kinematics, setup.robot
    longest = 0.0
    for leg, foot in zip(robot.leg_cards, kinematics.standing.feet, strict=True):
        hip = kinematics.hinge(leg.swing)[1][:2]
        longest = max(longest, float(np.linalg.norm(foot - hip)))
    weight = 9.81 * setup.model.body_mass.sum()
    assert carried_torque(setup) == pytest.approx(longest * weight, rel=1e-3)


def test_stiffened_servos_give_an_eight_hundredth_and_are_critically_damped(setup):
    model, joints = stiffened(setup), setup.robot.card.joints
    joints = actuators_driving(setup.model, joints)
    stiffness = model.actuator_gainprm[joints, 0]
    assert stiffness == pytest.approx(np.full(len(joints), 800 * carried_torque(setup)))
    assert GIVES == 1 / 800
    assert model.actuator_biasprm[joints, 1] == pytest.approx(-stiffness)
    dofs = model.jnt_dofadr[model.actuator_trnid[joints, 0]]
    critical = 2 * np.sqrt(stiffness * model.dof_M0[dofs])
    assert model.actuator_biasprm[joints, 2] == pytest.approx(-critical)
    assert not model.actuator_forcelimited[joints].any()
    names = [model.actuator(int(a)).trnid[0] for a in joints]
    assert names == [model.joint(j).id for j in setup.robot.card.joints]
    assert setup.model.actuator_gainprm[joints[0], 0] != stiffness[0]


def test_torque_that_is_needed_grows_with_speed_to_all_at_no_load():
    servo = SimpleNamespace(torque=2.0, speed=8.0)
    borne, turned = np.array([[0.5, 1.0]]), np.array([[0.0, 4.0]])
    assert _needed(servo, borne, turned) == pytest.approx(np.array([[0.5, 2.0]]))
    none = SimpleNamespace(torque=None, speed=None)
    assert _needed(none, borne, turned) == pytest.approx(borne)


def test_zeros_are_drawn_within_their_spread_or_given_one_by_one(setup):
    def drawn(**changes):
        scenario = replace(setup.scenario, **changes)
        return zero_offsets(scenario, 500)

    found = drawn(zero_offset=0.02)
    assert np.abs(found).max() <= 0.02
    assert found.std() == pytest.approx(0.02 / np.sqrt(3), rel=0.1)
    assert found.mean() == pytest.approx(0.0, abs=0.003)
    assert (found == drawn(zero_offset=0.02)).all()
    assert (found != drawn(zero_offset=0.02, draw=1)).any()
    assert drawn(zero_offset=(0.1, 0.2)).tolist() == [0.1, 0.2]


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_jump_that_friction_just_holds_is_gentle(share):
    rate = 100.0
    plain = prepare(
        load_scenario("line", {"command_rate": rate, "servo_stiffness": 400.0})
    )
    held = Drive(plain)._held_torque()
    assert held == pytest.approx(plain.scenario.friction * carried_torque(plain))
    speed = share * held * rate / 400.0
    changes = {"command_rate": rate, "servo_stiffness": 400.0, "swing_speed": speed}
    drive = Drive(prepare(load_scenario("line", changes)))
    if share < 1:
        drive.require_gentleness()
        return
    with pytest.raises(UsageError) as caught:
        drive.require_gentleness()
    said = str(caught.value)
    assert f"each of {rate:g} commands a second" in said
    assert f"by {share * held:.2g} N m, and friction holds {held:.2g} N m" in said
    assert f"raise command_rate to {int(np.ceil(rate * share))}" in said
    assert f"swing_speed={0.95 * speed / share:.2g}" in said


def test_a_slippery_floor_counts_as_one_of_a_tenth():
    low = prepare(load_scenario("line", {"friction": 0.01}))
    assert Drive(low)._held_torque() == pytest.approx(0.1 * carried_torque(low))
    assert LEAST_FRICTION == 0.1


@pytest.mark.parametrize(
    ("changes", "plain"),
    [
        ({}, True),
        ({"command_rate": 50.0}, False),
        ({"resolution": 0.01}, False),
        ({"zero_offset": 0.01}, False),
        ({"command_delay": 0.01}, False),
        ({"feed_forward": True}, False),
        ({"dead_band": 0.01}, False),
    ],
)
def test_commands_are_the_intended_angles_unless_something_changes_them(changes, plain):
    assert Drive(prepare(load_scenario("line", changes))).plain == plain


@pytest.mark.parametrize(("stiffness", "feeds"), [(299.0, True), (300.0, False)])
def test_servos_softer_than_300_are_fed_forward(stiffness, feeds):
    assert (
        Drive(
            prepare(load_scenario("line", {"servo_stiffness": stiffness}))
        ).feeds_forward
        == feeds
    )


@pytest.mark.parametrize(
    ("width", "odd"), [(0.9, 1), (1.4, 1), (1.6, 0), (3.0, 1), (0.2, 0)]
)
def test_swing_joints_whose_slack_is_odd_are_shifted_by_half_a_count(width, odd):
    made = prepare(load_scenario("line", {"resolution": 0.01, "servo": "ideal"}))
    joints = made.robot.card.joints
    found = _half_counts(made, np.full(len(joints), 0.01 * width))
    swings = [joints.index(joint) for joint in made.robot.swing_joints]
    best = np.zeros(len(joints))
    best[swings] = odd * 0.005 * np.sign(made.robot.swing_gain)
    assert found == pytest.approx(best)
    plain = prepare(load_scenario("line"))
    assert (_half_counts(plain, np.full(len(joints), 0.01)) == 0).all()


@pytest.fixture(scope="module")
def foreseeing():
    soft = {"servo_stiffness": 50.0, "feed_forward": "predicted"}
    return prepare(load_scenario("line", soft))


def test_commands_beyond_a_joint_s_range_are_refused_with_angle_and_time(foreseeing):
    """A torque of 50 N m bends a servo of 50 N m/rad by a whole radian."""
    scheduler = Scheduler(foreseeing.limits, foreseeing.at_rest, 2000)
    scheduler.hold(0.5)
    schedule, joints = scheduler.finish(), foreseeing.robot.card.joints
    joints = actuators_driving(foreseeing.model, joints)
    model, dt = foreseeing.model, foreseeing.limits.timestep
    low, high = model.actuator_ctrlrange[joints[3]]
    torques = np.zeros((6, model.nu))
    for sign, end in ((1, high), (-1, low)):
        drive = Drive(foreseeing)
        rest = drive._rest[3]
        torques[4, joints[3]] = 50 * (end - rest) + 10 * sign  # 0.2 rad beyond
        torques[2, joints[3]] = 50 * (end - rest) - 10 * sign
        with pytest.raises(SimulationError) as caught:
            drive.require_reach(schedule, FeedForward(torques, 100))
        assert caught.value.where == f"t = {2000 * dt + 400 * dt:.2f} s"
        name = model.actuator(int(joints[3])).name
        assert caught.value.what == (
            f"servo {name!r} would be commanded to {end + 0.2 * sign:.3f} rad, "
            f"beyond its range from {low:.3f} to {high:.3f} rad"
        )
        torques[4] = torques[2]
        drive.require_reach(schedule, FeedForward(torques, 100))
        torques[4, joints[3]] = 1e3
        measured = replace(
            foreseeing, servo=replace(foreseeing.servo, feed_forward=True)
        )
        Drive(measured).require_reach(schedule, FeedForward(torques, 100))
    drive.require_reach(schedule, None)
    endless = copy(model)
    endless.actuator_ctrllimited[joints] = 0
    Drive(replace(foreseeing, model=endless)).require_reach(
        schedule, FeedForward(torques, 100)
    )


def test_what_is_foreseen_of_a_stretch_is_read_after_each_of_its_commands(monkeypatch):
    """Of a made-up body whose servos bear ever more: t, 2 t and 3 t after t seconds."""
    given = {"command_rate": 100.0, "servo_stiffness": 50.0}
    setup = prepare(load_scenario("line", given))
    axis = np.array([[[0.0, 0, 1], [0, 1, 0]], [[0, -1, 0], [0, 0, 0]]])  # one lacks
    actuator, seen = np.array([[4, 0], [7, 0]]), []

    def made_up(known):
        assert known.servo.rate == 0  # the prediction knows no rate of commands
        assert known.model.actuator_gainprm[4, 0] > 50  # and no soft servos
        torque = np.array([[1.0, 2.0], [3.0, np.nan]])
        bears = SimpleNamespace(
            at=lambda t: SimpleNamespace(torque=t[:, None, None] * torque)
        )
        anatomy = SimpleNamespace(axis=axis, actuator=actuator)
        return SimpleNamespace(
            mechanics=SimpleNamespace(anatomy=anatomy), follow=lambda _: bears
        )

    def course_of(known, phases, legs, rows):
        seen.append((sum(map(len, rows)), [leg.pose.tolist() for leg in legs]))

    monkeypatch.setattr(rehearsal, "phases_of", made_up)
    monkeypatch.setattr(rehearsal, "course_of", course_of)
    foreseen, dt, start = Foreseen(setup), setup.limits.timestep, 0
    for number, lasting in ((1, 0.2), (2, 0.3)):
        scheduler = Scheduler(setup.limits, setup.at_rest, start)
        scheduler.hold(lasting)
        schedule = scheduler.finish()
        torques = foreseen.torques(schedule).at(np.array([100]))[0]
        after = (start + 100 + 1) * dt
        bearing = torques[[4, 0, 7]]
        assert bearing == pytest.approx(after * np.array([1, 2, 3]))
        assert np.count_nonzero(torques) == 3
        assert seen[-1] == (schedule.stop, [[0, 0, 0]] * number)
        start = schedule.stop
