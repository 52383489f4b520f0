"""Counts, pulses and calibrations at the borders of what servos can do."""

from dataclasses import replace
from math import degrees, pi
from types import SimpleNamespace

import numpy as np
import pytest

from models import SERVO_KINDS
from models.description import board_rate
from models.description.servos import JointServo
from sim.errors import UsageError
from sim.export.ros_table import read_ros_table
from sim.export.servo_commands import ServoCommands, taken
from sim.export.servo_table import Channel, ServoTable, servo_table

STRETCH = 4000  # steps of one record at most: a tenth of a second of work as a rule

MG90, BUS = SERVO_KINDS["mg90"], SERVO_KINDS["ax-12"]


JOINTS = ("one", "other")


CARD = SimpleNamespace(joint_servos={}, board_clock=25e6, board_divider=0, servo=None)


def table(make=MG90, pwm=True, given=None, rate=0.0, card=CARD):
    return servo_table(card, JOINTS, make, pwm, given, rate)


def commands(*angles):
    return ServoCommands(JOINTS, 50.0, np.array(angles, dtype=float))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_counts_and_angles_of_a_channel_are_inverse(sign):
    servo = Channel("j", 3, sign, 300.0, 0.2, 150.0, -1.0, 1.0)
    assert servo.counts(np.array([0.2, 0.4])) == pytest.approx([300, 300 + 30 * sign])
    angles = np.linspace(-1, 1, 7)
    assert servo.angle(servo.counts(angles)) == pytest.approx(angles)


@pytest.mark.parametrize("beyond", [-1e-8, 1e-8])
def test_a_servo_goes_to_its_reach_on_both_sides_of_its_offset(beyond):
    offset = 0.1
    given = {"one": JointServo(offset=offset), "other": JointServo()}
    made = table(given=given)
    for end in (offset - MG90.reach - beyond, offset + MG90.reach + beyond):
        one = commands([end, 0.0])
        if beyond < 0:
            assert made.require_range(one)[0, 0] == pytest.approx(end)
            continue
        with pytest.raises(UsageError) as caught:
            made.require_range(one)
        said = str(caught.value)
        assert f"goes to {end:.4f} rad ({degrees(end):.1f} degrees)" in said
        ends = f"from {offset - MG90.reach:.4f} to {offset + MG90.reach:.4f} rad"
        assert ends in said
        assert "channel 0" in said


def test_counts_are_whole_and_from_0_to_the_largest():
    wide = {j: JointServo(center=150.0, limits=(-9.0, 99.0)) for j in JOINTS}
    made, step = table(given=wide), MG90.resolution
    assert made.counts(commands([-150.4 * step, 1.6 * step])).tolist() == [[0, 152]]
    with pytest.raises(UsageError, match="'one' goes to"):
        made.counts(commands([-150.6 * step, 0.0]))
    most = made.largest - 150
    assert made.largest == 4095
    assert made.counts(commands([0.0, (most + 0.4) * step]))[0, 1] == 4095
    with pytest.raises(UsageError) as caught:
        made.counts(commands([0.0, (most + 0.6) * step]))
    ends = f"from {-150 * step:.4f} to {most * step:.4f} rad"
    assert ends in str(caught.value)


@pytest.mark.parametrize("center", [2048.0, 50.0])
def test_counts_that_are_of_no_pulse_are_refused(center):
    """Ticks of a bus would be pulses of 8 ms."""
    with pytest.raises(UsageError, match="'one', count .*, is a pulse of .* us"):
        table(given={j: JointServo(center=center) for j in JOINTS})


@pytest.mark.parametrize("center", [0.0, 1023.0])
def test_servos_of_a_card_have_no_more_ticks_than_their_make(center):
    servos = {j: JointServo(channel=n, center=center) for n, j in enumerate(JOINTS, 1)}
    card = SimpleNamespace(joint_servos=servos, board_clock=25e6, board_divider=0)
    made = servo_table(card, JOINTS, BUS, False)
    with pytest.raises(UsageError, match="goes to"):
        made.counts(commands([0.0, 0.01 if center else -0.01]))
    given = servo_table(card, JOINTS, BUS, False, servos)  # of a table of others
    assert (made.largest, given.largest) == (1023, 4095)
    near = replace(SERVO_KINDS["xl-330"], reach=1.2)  # which turns less far
    assert servo_table(card, JOINTS, near, False).largest == 4095


def test_counts_of_pulses_are_no_ticks():
    servos = {j: JointServo(center=371.0, counts_per_radian=111.4) for j in JOINTS}
    card = SimpleNamespace(joint_servos=servos, board_clock=25e6, board_divider=102)
    made = servo_table(card, JOINTS, MG90, False)
    assert {(s.center, s.counts_per_radian) for s in made.channels} == {
        (2048, 2048 / np.pi)
    }
    for made in (SERVO_KINDS["xl-330"], None):  # a bus, and servos of no make
        with pytest.raises(UsageError, match="counts of its servos are of pulses"):
            servo_table(card, JOINTS, made, False)
    assert servo_table(card, JOINTS, SERVO_KINDS["xl-330"], None).joints == JOINTS
    given = {j: JointServo(channel=n) for n, j in enumerate(JOINTS, 1)}
    assert servo_table(card, JOINTS, SERVO_KINDS["xl-330"], False, given).channels


def test_ticks_of_a_bus_are_no_pulses():
    servos = {j: JointServo(center=512.0, counts_per_radian=195.6) for j in JOINTS}
    card = SimpleNamespace(joint_servos=servos, board_clock=25e6, board_divider=0)
    bus = SERVO_KINDS["ax-12"]
    assert {s.center for s in servo_table(card, JOINTS, bus, False).channels} == {512}
    with pytest.raises(UsageError, match="servos on a bus take no pulses, and joint"):
        servo_table(card, JOINTS, bus, True)
    card = SimpleNamespace(joint_servos=servos, board_clock=25e6, board_divider=102)
    card.servo = None
    pulses = servo_table(card, JOINTS, bus, True, rate=60.0)
    assert {s.joint for s in pulses.channels} == {*JOINTS}
    given = servo_table(card, JOINTS, bus, True, servos, 60.0)  # a table says what
    assert {s.center for s in given.channels} == {512}


def test_angles_are_in_the_order_of_channels():
    given = {"one": JointServo(channel=9), "other": JointServo(channel=2)}
    made = table(given=given)
    assert made.joints == ("other", "one")
    counts = made.counts(commands([0.1, -0.2], [0.3, 0.4]))
    again = made.commands(counts, 50.0)
    assert again.joints == ("other", "one")
    assert again.rate == 50.0
    half = 0.5 * MG90.resolution
    assert again.angles == pytest.approx(np.array([[-0.2, 0.1], [0.4, 0.3]]), abs=half)
    assert not made.assumed
    assert table(given={"one": JointServo()}).assumed
    assert [s.channel for s in table().channels] == [0, 1]


def test_two_joints_on_a_channel_are_refused():
    given = {j: JointServo(channel=4) for j in JOINTS}
    with pytest.raises(UsageError, match="'one' and 'other' are both on channel 4"):
        table(given=given)


def test_a_servo_that_could_not_move_is_refused():
    """Radians a count, say, in place of counts a radian."""
    assert table(given={"one": JointServo(counts_per_radian=10.0)})
    with pytest.raises(UsageError, match="turns joint 'one' by 0.101 rad, as no servo"):
        table(given={"one": JointServo(counts_per_radian=9.9)})


@pytest.mark.parametrize(("pwm", "most"), [(True, 255), (False, 253)])
def test_channels_that_no_board_or_bus_has_are_refused(pwm, most):
    """A header holds them in bytes, and a bus has other uses for 254 and 255."""
    assert table(given={"other": JointServo(channel=most)}, pwm=pwm)
    with pytest.raises(UsageError, match=f"joint 'other' is on channel {most + 1}: "):
        table(given={"other": JointServo(channel=most + 1)}, pwm=pwm)


def test_pulses_are_as_long_in_microseconds_as_in_counts_of_a_frame():
    made = table()
    told = made.in_microseconds()
    frame = 1e6 / made.frame_rate
    for one, other in zip(made.channels, told.channels, strict=True):
        angles = np.array([-1.0, 0.0, 0.7])
        assert other.counts(angles) == pytest.approx(one.counts(angles) * frame / 4096)
    assert told.largest == round(frame) - 1
    assert told.microseconds
    assert not made.microseconds


@pytest.mark.parametrize(
    ("rate", "changed"),
    [(23.9, False), (24.0, True), (100.0, True), (1526.0, True), (1526.1, False)],
)
def test_frames_are_given_at_the_rate_of_commands_where_a_board_can(rate, changed):
    made = table(rate=rate)
    if not changed:
        assert made.frame_rate == MG90.command_rate
        return
    assert made.frame_rate == pytest.approx(board_rate(rate, 25e6))
    longer = made.frame_rate / MG90.command_rate
    assert made.channels[0].counts_per_radian == pytest.approx(longer / MG90.resolution)


def test_ticks_of_a_bus_are_those_of_a_make_or_of_a_turn():
    made = table(BUS, pwm=False)
    assert made.frame_rate == 0
    assert made.largest == round(2 * BUS.reach / BUS.resolution) - 1
    assert made.channels[0].center == BUS.center
    plain = table(None, pwm=False)
    assert plain.largest == 4095
    assert plain.channels[0].center == 2048
    assert plain.channels[0].counts_per_radian == pytest.approx(4096 / (2 * pi))
    assert (plain.channels[0].low, plain.channels[0].high) == (-pi, pi)
    known = table(BUS, pwm=False, given={j: JointServo() for j in JOINTS})
    assert known.largest == 4095
    alone = table(None, pwm=None)
    assert (alone.channels[0].low, alone.channels[0].high) == (-np.inf, np.inf)
    pulses = table(None, pwm=True)
    assert pulses.channels[0].center == MG90.center
    assert table(MG90, pwm=False).largest == 4095
    assert table(MG90, pwm=None).channels[0].high == MG90.reach


def test_a_servo_on_a_bus_takes_pulses_only_if_they_are_given():
    whole = JointServo(center=300.0, counts_per_radian=100.0)
    assert table(BUS, pwm=True, given=dict.fromkeys(JOINTS, whole)).frame_rate == 60.0
    for part in ({"center": None}, {"counts_per_radian": None}):
        given = {"one": whole, "other": replace(whole, **part)}
        with pytest.raises(
            UsageError, match="take no pulses, and joint 'other' has one"
        ):
            table(BUS, pwm=True, given=given)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("- {name: a, id: 1, ticks: 0, center: 5, max_radians: 1}", "must be positive"),
        ("- {name: a, id: 1, ticks: 9, center: 5, max_radians: 0}", "must be positive"),
        ("- {name: a, id: 1, ticks: 9, center: 5, max_radians: 13}", "dians to 12.5"),
        ("[]", "no servos"),
        ("{}", "no servos"),
        ("SERVOS: 3", "no servos"),
    ],
)
def test_ros_tables_have_servos_with_ticks_over_an_angle(tmp_path, text, said):
    path = tmp_path / "servos.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=said):
        read_ros_table(path)


def test_a_ros_servo_goes_from_its_first_tick_to_its_last(tmp_path):
    path = tmp_path / "servos.yaml"
    path.write_text("a: {name: a, id: 7, ticks: 100, center: 30, max_radians: 2}\n")
    servo = read_ros_table(path)["a"]
    assert (servo.channel, servo.sign, servo.center, servo.offset) == (7, 1, 30, 0)
    assert servo.counts_per_radian == 50
    assert servo.limits == pytest.approx((-0.6, 1.38))


def test_rows_of_commands_come_in_stretches():
    held = ServoCommands(JOINTS, 50.0, np.array([[1.0, 2.0]]))
    blocks = list(held.rows(2 * STRETCH + 3, 0.001))
    assert [len(block) for block in blocks] == [STRETCH, STRETCH, 3]
    assert (np.concatenate(blocks) == [1.0, 2.0]).all()
    one = list(held.rows(5, 0.001, interpolated=True))
    assert (np.concatenate(one) == [1.0, 2.0]).all()


def test_interpolated_commands_go_on_across_stretches():
    count = 400
    ramp = ServoCommands(("a",), 50.0, np.arange(float(count))[:, None])
    steps = count * 20
    rows = np.concatenate(list(ramp.rows(steps, 0.001, interpolated=True)))
    best = np.minimum(np.arange(steps) * 0.05, count - 1)
    assert rows[:, 0] == pytest.approx(best)


@pytest.mark.parametrize("rate", [1000.0, 1000.1])
def test_commands_are_at_most_one_a_step(rate):
    ctrl = np.arange(10.0)[:, None]
    if rate > 1000:
        with pytest.raises(UsageError, match="give at most 1000"):
            taken(ctrl, ("a",), np.array([0]), rate, 0.001)
    else:
        found = taken(ctrl, ("a",), np.array([0]), rate, 0.001)
        assert found.angles[:, 0].tolist() == ctrl[:, 0].tolist()


@pytest.mark.parametrize(
    ("rate", "angles", "said"),
    [
        (np.inf, np.zeros((1, 2)), "rate must be positive, got inf"),
        (-1.0, np.zeros((1, 2)), "rate must be positive, got -1"),
        (50.0, np.zeros(2), r"angles of shape \(2,\) for 2 joints"),
        (50.0, np.zeros((1, 3)), r"angles of shape \(1, 3\) for 2 joints"),
        (50.0, np.zeros((0, 2)), "no command"),
        (50.0, np.full((1, 2), np.nan), "not a finite number"),
    ],
)
def test_commands_are_finite_angles_of_all_joints(rate, angles, said):
    with pytest.raises(ValueError, match=said):
        ServoCommands(JOINTS, rate, angles)
    assert isinstance(table(), ServoTable)


def test_a_make_without_counts_has_no_pulses_and_has_angles():
    smooth = replace(MG90, resolution=0.0)
    with pytest.raises(UsageError, match="a count turns joint 'one' by 1 rad"):
        table(smooth)
    assert table(smooth, pwm=None).joints == JOINTS
