"""Files for servos: what is read back differs by half a count at most."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from models.description.servos import SERVO_KINDS, JointServo
from models.library import load
from sim.errors import UsageError
from sim.export import source
from sim.export.header import identifier, read_header, write_header
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import Channel, ServoTable, servo_table
from sim.export.source import (
    Source,
    read_table,
    read_trajectory,
    write_table,
    write_trajectory,
)

MG90 = SERVO_KINDS["mg90"]
CARD = load("hexapod-classroom").card
JOINTS = CARD.joints
MIRRORED = {
    "swing_1": JointServo(channel=11, sign=-1, center=350.5, offset=0.2),
    "lift_6": JointServo(channel=0, counts_per_radian=120.0, limits=(-0.9, 0.9)),
    "lift_1": JointServo(channel=12),
}
TITLE = {"title": "line on a robot", "name": "line", "file": "line.h"}


@pytest.fixture
def commands():
    angles = np.random.default_rng(3).uniform(-0.8, 0.8, (200, len(JOINTS)))
    return ServoCommands(JOINTS, 60.0, angles)


def table(pwm=True, given=None, kind="mg90"):
    return servo_table(CARD, JOINTS, SERVO_KINDS.get(kind), pwm, given)


def in_order(read):
    order = [read.joints.index(joint) for joint in JOINTS]
    return read.angles[:, order]


def test_angles_are_read_back_to_the_last_digit(commands):
    text = write_table(commands)
    assert text.splitlines()[0] == ",".join(("time", *JOINTS))
    read = read_table(text)
    assert read.rate == pytest.approx(60.0, rel=1e-12)
    assert (read.angles == commands.angles).all()


@pytest.mark.parametrize("given", [None, MIRRORED], ids=["by order", "by table"])
@pytest.mark.parametrize("unit", ["counts", "microseconds"])
def test_a_header_is_read_back_to_half_a_count(commands, given, unit):
    servos = table(given=given)
    servos = servos.in_microseconds() if unit == "microseconds" else servos
    text = write_header(commands, servos, **TITLE)
    read = read_header(text, servos)
    assert read.rate == 60.0
    half = {s.joint: 0.5 / s.counts_per_radian for s in servos.channels}
    off = np.abs(in_order(read) - commands.angles).max(axis=0)
    assert (off <= np.array([half[joint] for joint in JOINTS]) + 1e-12).all()
    assert off.max() > 0.4 * min(half.values())  # counts are as coarse as they say
    assert unit in text
    assert "PROGMEM" in text


def test_counts_of_a_make_are_those_of_its_data_sheet(commands):
    counts = table().counts(commands)
    # 350 counts are 180 degrees, about 365
    wanted = 365 + commands.angles * 350 / np.pi
    assert np.abs(counts - wanted).max() <= 0.5 + 1e-9
    micro = table().in_microseconds().counts(commands)
    assert np.abs(micro - wanted * 1e6 / 60 / 4096).max() <= 0.5 + 1e-9


def test_pulses_for_bus_servos_are_refused_unless_their_counts_are_given():
    said = "servos on a bus take no pulses, and joint 'swing_1' has"
    with pytest.raises(UsageError, match=said):
        table(kind="ax-12")
    own = JointServo(center=300, counts_per_radian=100.0)
    assert table(kind="ax-12", given=dict.fromkeys(JOINTS, own)).frame_rate == 60


def test_names_in_c_are_letters_and_digits():
    assert re.fullmatch(r"[A-Za-z_]\w*", identifier("über 2-fach.int"))


def test_a_trajectory_is_yaml_with_rising_times(commands):
    text = write_trajectory(commands)
    message = yaml.safe_load(text)
    assert message["joint_names"] == list(JOINTS)
    times = [p["time_from_start"] for p in message["points"]]
    assert all(0 <= t["nanosec"] < 10**9 for t in times)
    seconds = [t["sec"] + t["nanosec"] / 1e9 for t in times]
    assert seconds == pytest.approx(commands.time, abs=0.6e-9)
    read = read_trajectory(text)
    assert np.abs(read.angles - commands.angles).max() <= 0.5e-9 + 1e-15
    assert read.rate == pytest.approx(60.0, rel=1e-9)


def test_small_angles_stay_numbers_in_yaml():
    tiny = ServoCommands(("a",), 50.0, np.array([[1e-7], [-1e-12]]))
    points = yaml.safe_load(write_trajectory(tiny))["points"]
    assert [p["positions"] for p in points] == [[1e-7], [0.0]]


def test_ticks_are_4096_a_turn_about_2048_where_nothing_is_said(commands):
    servos = table(pwm=False, kind="ideal")
    text = write_table(commands, servos)
    values = np.genfromtxt(text.splitlines(), delimiter=",", names=True)
    assert values.dtype.names == ("time", *JOINTS)
    wanted = np.round(2048 + commands.angles[:, 3] * 4096 / (2 * np.pi))
    assert (values[JOINTS[3]] == wanted).all()
    read = read_table(text, servos)
    assert np.abs(read.angles - commands.angles).max() <= np.pi / 4096 + 1e-12


def test_ticks_of_a_make_are_those_of_its_data_sheet(commands):
    counts = table(pwm=False, kind="ax-12").counts(commands)
    wanted = np.round(512 + np.degrees(commands.angles) * 1024 / 300)
    assert (counts == wanted).all()


@pytest.mark.parametrize("kind", ["mg90", "ax-12", "xl-330", "ideal"])
@pytest.mark.parametrize("pwm", [True, False, None])
def test_a_joint_out_of_its_servos_range_is_refused_by_name(commands, kind, pwm):
    angles = commands.angles.copy()
    angles[17, 5] = 3.3
    beyond = ServoCommands(JOINTS, 60.0, angles)
    if pwm and kind in ("ax-12", "xl-330"):
        return  # pulses are refused as such
    servos = table(pwm=pwm, kind=kind)
    if kind == "ideal" and pwm is None:  # angles of servos that nothing is known of
        servos.require_range(beyond)
        return
    with pytest.raises(UsageError, match=r"joint 'lift_3' goes to 3\.3000 rad .* from"):
        servos.require_range(beyond)


def test_limits_of_a_card_are_kept(commands):
    narrow = {"swing_2": JointServo(limits=(-0.1, 0.1))}
    with pytest.raises(UsageError, match=r"'swing_2' goes to .* from -0\.1000 to 0\.1"):
        table(given=narrow).require_range(commands)


def test_counts_beyond_what_servos_have_are_refused(commands):
    with pytest.raises(UsageError, match="'swing_2' goes to"):
        table(given={"swing_2": JointServo(center=80.0)}).counts(commands)


def test_two_joints_on_one_channel_are_refused():
    with pytest.raises(UsageError, match="'swing_1' and 'swing_2' are both on chan"):
        table(given={"swing_2": JointServo(channel=0)})


@pytest.mark.parametrize("text", ["", "time\n0\n", "a,b\n1,2\n", "time,a\n0,x\n1,2"])
def test_what_is_no_table_is_refused(text):
    with pytest.raises(ValueError, match="."):
        read_table(text)


def test_frames_come_as_often_as_commands_and_counts_are_parts_of_a_frame(commands):
    slower = ServoCommands(JOINTS, 50.0, commands.angles)
    servos = servo_table(CARD, JOINTS, MG90, True, rate=50.0)
    text = write_header(slower, servos, **TITLE)
    assert "#define WALK_LINE_FRAME_RATE 50.0" in text
    # the same pulses: 365 counts of 1/60 s at the middle, 350 for half a turn
    pulses = servos.counts(slower) / 50.0
    wanted = (365 + commands.angles * 350 / np.pi) / 60.0
    assert np.abs(pulses - wanted).max() <= 1.0 / 50  # half a count, and of the middle
    assert np.abs(in_order(read_header(text, servos)) - commands.angles).max() < 0.006


def test_a_rate_that_no_pulses_have_leaves_those_of_the_make(commands):
    assert servo_table(CARD, JOINTS, MG90, True, rate=2000.0).frame_rate == 60


@pytest.mark.parametrize(("unit", "longest"), [("counts", 4095), ("pulses", 19_999)])
def test_a_pulse_is_at_least_nothing_and_shorter_than_its_frame(unit, longest):
    """A frame is 4096 counts, or at 50 pulses a second 20,000 microseconds, long."""
    servo = Channel("a", 0, 1.0, 0.0, 0.0, 4096.0, low=-9.0, high=9.0)
    servos = ServoTable((servo,), 4095, frame_rate=50.0)
    servos = servos.in_microseconds() if unit == "pulses" else servos

    def counts(part):
        angles = np.array([[part / (longest + 1)]])
        return servos.counts(ServoCommands(("a",), 50.0, angles)).item()

    assert (counts(0), counts(longest)) == (0, longest)
    for beyond in (-1, longest + 1):
        with pytest.raises(UsageError):
            counts(beyond)


@pytest.mark.parametrize(
    ("limited", "most", "refused"),
    [(False, 6.2, False), (False, 99.0, True), (True, 0.9, False), (True, 2.0, True)],
)
def test_commands_far_beyond_what_a_joint_turns_are_refused(
    monkeypatch, limited, most, refused
):
    """Beyond its range by more than it lags behind, or beyond all turns without one."""
    found = SimpleNamespace(angles=np.array([[-most], [most]]))
    monkeypatch.setattr(source, "taken", lambda *given: found)
    monkeypatch.setattr(source, "actuators_driving", lambda *given: None)
    joint = SimpleNamespace(range=np.array([-0.5, 0.5]), limited=limited)
    run = SimpleNamespace(commands={"ctrl": None}, folder="walk")
    own = SimpleNamespace(
        run=run, joints=("j",), servo=SimpleNamespace(rate=50.0),
        timestep=0.001, model=SimpleNamespace(joint=lambda name: joint),
    )  # fmt: skip
    if not refused:
        assert source.Source.commands(own, 50.0) is found
        return
    with pytest.raises(UsageError, match=f"'j' is commanded from -{most:.3g} to"):
        source.Source.commands(own, 50.0)


def test_a_table_that_begins_later_has_the_rate_of_its_rows():
    text = "time,a\n5.0,0.1\n5.02,0.2\n5.04,0.3\n"
    commands = read_table(text)
    assert commands.rate == pytest.approx(50.0)
    assert commands.angles.tolist() == [[0.1], [0.2], [0.3]]


def test_rates_that_leave_a_single_command_are_refused(monkeypatch):
    monkeypatch.setattr(source, "actuators_driving", lambda *_: np.array([0]))
    joint = SimpleNamespace(limited=False)
    own = SimpleNamespace(
        run=SimpleNamespace(commands={"ctrl": np.zeros((1000, 1))}),
        servo=SimpleNamespace(rate=0.0),
        joints=("a",),
        timestep=0.001,
        steps=1000,
        model=SimpleNamespace(joint=lambda name: joint),
    )
    with pytest.raises(UsageError, match="0.5 commands a second are fewer than two"):
        Source.commands(own, 0.5)
    assert len(Source.commands(own, 1.01).angles) == 2
