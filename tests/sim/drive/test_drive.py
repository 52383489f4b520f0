"""Servo commands: feed-forward, counts and rate, against their definitions."""

import mujoco
import numpy as np
import pytest

from models.description import actuator_of, actuators_driving
from models.description.servos import SERVO_KINDS, ServoKind
from planner.systems.flows import Flow
from sim.drive.drive import Drive
from sim.drive.feed_forward import FeedForward, smoothed
from sim.drive.rehearsal import Rehearsal
from sim.errors import UsageError
from sim.motion.schedule import Scheduler
from sim.physics.engine import Engine
from sim.preparation.setup import prepare
from tests.walks import simulated

PASSED = 2.0  # counts above the floor that a foot passes in a single command

SOFT = {"servo_stiffness": 50.0, "servo_damping": 1.0}


def swung(setup, angle=0.2):
    """Tripod 1 swings under load, tripod 2 in the air."""
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.enter("1")
    flow = next(f for f in setup.equations.swings if f == "g1_1")
    scheduler.flow(Flow("1", flow, angle), setup.equations.swings[flow])
    scheduler.enter("12")
    return scheduler.finish()


def rows(drive, schedule, torques=None):
    return np.concatenate(list(drive.commands(schedule, torques)))


def intended(setup, schedule):
    return np.concatenate(list(setup.commands(schedule)))


def test_ideal_servos_are_told_the_intended_angles(scenario):
    setup = prepare(scenario())
    drive, schedule = Drive(setup), swung(setup)
    assert drive.plain
    assert (rows(drive, schedule) == intended(setup, schedule)).all()


@pytest.mark.parametrize("rate", [50.0, 60.0, 333.0])
def test_a_command_starts_at_the_first_step_at_or_after_its_time(scenario, rate):
    setup = prepare(scenario(command_rate=rate, feed_forward=False, **SOFT))
    schedule = swung(setup)
    told, wanted = rows(Drive(setup), schedule), intended(setup, schedule)
    starts = np.ceil(np.arange(40) / rate / setup.limits.timestep - 1e-6).astype(int)
    for start, stop in zip(starts[:-1], starts[1:], strict=True):
        assert (told[start:stop] == wanted[start]).all()


def test_commands_hold_across_the_stretches_of_a_walk(scenario):
    setup = prepare(scenario(command_rate=7.0, feed_forward=False, **SOFT))
    drive = Drive(setup)
    first = Scheduler(setup.limits, setup.at_rest)
    first.hold(0.25)  # commands come at 0, 1/7, 2/7 s, the last in the next stretch
    held = rows(drive, first.finish())
    later = Scheduler(setup.limits, setup.at_rest, len(held))
    later.enter("1")
    told = rows(drive, later.finish())
    until = round(2 / 7 / setup.limits.timestep + 0.5) - len(held)
    assert (told[:until] == held[-1]).all()
    assert (told[until] != held[-1]).any()


def test_counts_are_whole_multiples_of_the_resolution_from_joint_zero(scenario):
    resolution = 0.009
    given = {"resolution": resolution, "feed_forward": False}
    setup = prepare(scenario(**given, **SOFT))
    schedule = swung(setup)
    told, wanted = rows(Drive(setup), schedule), intended(setup, schedule)
    counts = told / resolution
    assert np.abs(counts - np.round(counts)).max() < 1e-9
    off, names = np.abs(told - wanted).max(axis=0), range(setup.model.nu)
    swings = [i for i in names if setup.model.actuator(i).name.startswith("swing")]
    assert off[swings].max() <= resolution / 2 + 1e-12
    assert off.max() <= PASSED * resolution  # of feet that are about to touch


def test_legs_that_rest_between_counts_swing_by_the_same_counts(scenario):
    given = {"robot": "hexapod-radial", "resolution": 0.009, "feed_forward": False}
    setup = prepare(scenario(**given, **SOFT))
    told = rows(Drive(setup), swung(setup))
    joints = [setup.robot.leg_cards[place].swing for place in (0, 4)]  # 1 and 5
    stand = [setup.robot.standing_angle(joint) / 0.009 for joint in joints]
    assert stand == pytest.approx([43.46, -43.46], abs=0.01)
    one, five = (told[:, actuator_of(setup.model, j)] for j in joints)
    assert np.ptp(one) > 0.1
    apart = np.abs((one - one[0]) - (five - five[0]))
    assert (apart > 1e-9).mean() < 0.01  # in the very middle between two counts


def test_zeros_that_are_off_shift_whole_counts(scenario):
    given = {"resolution": 0.009, "feed_forward": False, **SOFT}
    true, off = (prepare(scenario(zero_offset=z, **given)) for z in (0.0, 0.02))
    schedule = swung(true)
    shift = rows(Drive(off), schedule) - rows(Drive(true), schedule)
    assert np.abs(shift - shift[0]).max() < 1e-12
    assert np.abs(shift).max() > 0.01


def test_commands_lead_by_torque_and_damping_over_stiffness(scenario):
    setup = prepare(scenario(feed_forward=True, **SOFT))
    schedule = swung(setup)
    steps, joints = (
        schedule.stop - schedule.start,
        actuators_driving(setup.model, setup.robot.card.joints),
    )
    torque = np.full((2, setup.model.nu), 0.3)
    told = rows(Drive(setup), schedule, FeedForward(torque, spacing=steps))
    wanted = intended(setup, schedule)
    middle = slice(1, -1)
    speed = (wanted[2:] - wanted[:-2]) / (2 * setup.limits.timestep)
    expected = (0.3 + 1.0 * speed[:, joints]) / 50.0
    ahead = told[middle][:, joints] - wanted[middle][:, joints]
    # rounding of differences of angles over a timestep
    assert ahead == pytest.approx(expected, abs=1e-9)


def test_smoothed_torques_keep_constants_and_straight_lines():
    timestep, count = 0.0005, 2000
    line = np.linspace(0, 1, count)[:, None] * [1.0, -2.0]
    smooth = smoothed(line + 3.0, timestep)
    inner = np.arange(100, count - 100)
    assert smooth.at(inner) == pytest.approx(line[inner] + 3.0, abs=1e-9)
    assert smooth.at(np.array([0, count - 1])).shape == (2, 2)


@pytest.mark.physics
def test_a_rehearsal_with_soft_servos_measures_the_torques_of_stiff_ones(scenario):
    soft, stiff = (prepare(scenario(**given)) for given in (SOFT, {}))
    scheduler = Scheduler(stiff.limits, stiff.at_rest)
    scheduler.enter("1")
    scheduler.hold(0.5)
    schedule = scheduler.finish()
    rehearsed = Rehearsal(soft).torques(schedule).values[-1]
    engine = Engine(stiff.model)
    for ctrl in stiff.commands(schedule):
        borne = engine.advance(ctrl).actuator_force[-1]
    # both robots' servos are about as stiff; what is left is friction held in stance
    assert rehearsed == pytest.approx(borne, abs=0.05 * np.abs(borne).max())


@pytest.mark.physics
def test_soft_servos_with_lead_go_where_stiff_ones_go(scenario):
    def off(**changes):
        summary = simulated(scenario(**changes)).summary
        assert summary["servo"]["feed_forward"] is changes.get("feed_forward", True)
        return summary["error"]["quasi_static"]["farthest"]

    led = off(command_rate=50.0, **SOFT)
    # 14 mm of path; measured 0.22 mm with feed-forward and 0.97 mm without
    assert led < 0.3e-3
    assert led < off(command_rate=50.0, feed_forward=False, **SOFT) / 3


@pytest.mark.parametrize("name", SERVO_KINDS)
def test_every_make_has_a_source_and_whole_counts(name):
    kind = SERVO_KINDS[name]
    assert kind.source
    assert kind.stiffness == pytest.approx(kind.stall_torque / kind.full_error)
    assert kind.resolution > 0
    assert kind.command_rate > 0


def test_a_make_of_no_torque_is_refused():
    with pytest.raises(ValueError, match="stall_torque must be positive"):
        ServoKind(stall_torque=0.0, no_load_speed=1.0, full_error=0.1)


def test_an_unknown_make_is_refused_with_those_known(scenario):
    with pytest.raises(UsageError, match="servo = 'mg9' is unknown") as refusal:
        prepare(scenario(servo="mg9"))
    assert "did you mean 'mg90'?" in refusal.value.remedy


def test_what_is_simulated_stands_in_the_model(scenario):
    setup = prepare(scenario(servo="ax-12"))
    model, joints = setup.model, actuators_driving(setup.model, setup.robot.card.joints)
    kind = SERVO_KINDS["ax-12"]
    assert model.actuator_gainprm[joints, 0] == pytest.approx(kind.stiffness)
    assert model.actuator_forcerange[joints, 1] == pytest.approx(kind.stall_torque)
    inertia = model.dof_M0[model.jnt_dofadr[model.actuator_trnid[joints, 0]]]
    critical = 2 * np.sqrt(kind.stiffness * inertia)
    # the compiler takes the ratio at the file's zero, not at the keyframe: 1.5 % apart
    assert -model.actuator_biasprm[joints, 2] == pytest.approx(critical, rel=0.02)
    assert isinstance(model, mujoco.MjModel)


def test_nobody_knows_the_imperfections_when_torques_are_rehearsed(scenario):
    heavy = {"payload": [0.3, 0.03, 0.0, 0.02], "backlash": 0.01, "slope": [0.05, 0.0]}
    plain, laden = (prepare(scenario(**SOFT | given)) for given in ({}, heavy))
    schedule = swung(plain)
    torques = [Rehearsal(setup).torques(schedule).values for setup in (plain, laden)]
    assert (torques[0] == torques[1]).all()


def test_a_delay_shifts_all_commands_by_as_much(scenario):
    late, told = (
        prepare(scenario(command_delay=seconds, **SOFT)) for seconds in (0.025, 0.0)
    )
    schedule = swung(told)
    on_time, delayed = (rows(Drive(setup), schedule) for setup in (told, late))
    assert (delayed[25:] == on_time[:-25]).all()
    assert (delayed[:25] == on_time[0]).all()
    assert (on_time[25] != on_time[-1]).any()


@pytest.mark.physics
def test_a_motor_behind_a_proportional_controller_walks_as_the_springs_do(scenario):
    """MuJoCo's own direct-current motor, with the numbers of the make's data sheet."""
    setup = prepare(scenario(robot="hexapod-classroom"))
    kind, volts = SERVO_KINDS["mg90"], 6.0
    spec, springs = mujoco.MjSpec.from_string(setup.world.text), setup.model
    for servo in spec.actuators:
        number = springs.actuator(servo.name).id
        stiffness = springs.actuator_gainprm[number, 0]
        damping = -springs.actuator_biasprm[number, 2]
        servo.set_to_dcmotor(
            motorconst=[0, 0],
            resistance=0,
            nominal=[volts, kind.stall_torque, kind.no_load_speed],
            controller=[stiffness, 0, damping, 0, 0, volts],
            ctrlspec=1,  # a position is what it is told
        )
    told = rows(Drive(setup), swung(setup))
    ends = []
    for model in (springs, spec.compile()):
        engine = Engine(model)
        pieces = np.array_split(told, len(told) // 2000 + 1)
        ends.append([engine.advance(piece).qpos[-1] for piece in pieces])
    # kicks of a count come to the voltage's limit for single steps: 1e-5 was measured
    assert np.abs(np.subtract(*ends)).max() < 1e-4


def test_numbers_of_a_data_sheet_replace_those_of_the_make(scenario):
    given = {"stall_torque": 0.3, "no_load_speed": 10.0, "full_error": 0.03}
    found = prepare(
        scenario(robot="hexapod-classroom", servo="pulse", servo_data=given)
    )
    assert found.servo.stiffness == pytest.approx(0.3 / 0.03)
    assert (found.servo.torque, found.servo.speed) == (0.3, 10.0)
    halved = prepare(scenario(robot="hexapod-classroom", servo_data={"volts": 3.0}))
    make = SERVO_KINDS["mg90"]
    assert halved.servo.torque == pytest.approx(make.stall_torque / 2)
    assert halved.servo.speed == pytest.approx(make.no_load_speed / 2)
    with pytest.raises(UsageError, match="no stall_torque and no no_load_speed"):
        prepare(scenario(robot="hexapod-classroom", servo="bus"))


@pytest.mark.parametrize(
    ("robot", "servo"), [("hexapod", None), ("hexapod-classroom", "ideal")]
)
def test_ideal_servos_have_no_data_sheet(scenario, robot, servo):
    asked = scenario(robot=robot, servo=servo, servo_data={"volts": 3.0})
    with pytest.raises(UsageError, match="'volts': 3.0.*ideal servos have none"):
        prepare(asked)


def test_pulses_come_at_the_rate_that_a_board_can_give(scenario):
    servo = prepare(scenario(robot="hexapod-classroom")).servo
    make, rate = SERVO_KINDS["mg90"], 25e6 / 4096 / 102
    assert servo.rate == pytest.approx(rate)  # and not 60
    assert servo.resolution == pytest.approx(make.resolution * 60 / rate)
