"""Makes of servo by the names that are written on them and on their data sheets."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest

from models.description import KNOWN_SERVOS, servo_of
from models.description.servos import JointServo, ServoKind
from planner.support import shipped_tables

BOARD_COUNTS = 4096  # in a frame
START_UP = 0.03


@pytest.mark.parametrize(
    ("written", "make"),
    [("9g", "sg90"), ("MG90S", "mg90"), ("MG996", "mg996r"), ("LX16A", "lx-16a")],
)
def test_a_make_is_known_by_what_is_written_on_it(written, make):
    assert servo_of(written) == KNOWN_SERVOS[make]
    assert written.lower() not in KNOWN_SERVOS  # so that lists name each make once


def test_a_pulse_servo_s_numbers_follow_from_its_data_sheet():
    """A board's counts are parts of a frame, of which there are 50 a second."""
    sg90 = KNOWN_SERVOS["sg90"]
    sheet = shipped_tables("models.description", "makes.toml")["sg90"]
    assert sg90.stall_torque == pytest.approx(sheet["kgf_cm"] * 9.80665e-2)
    assert sg90.no_load_speed == pytest.approx(np.deg2rad(60) / sheet["seconds"])
    assert sg90.reach == pytest.approx(np.deg2rad(sheet["degrees"]) / 2)
    microsecond = np.deg2rad(sheet["degrees"]) / 2000
    assert sg90.dead_band == pytest.approx(sheet["dead_pulse"] * microsecond)
    assert sg90.full_error == pytest.approx(3 * sg90.dead_band)
    count = 1e6 / BOARD_COUNTS / 50
    assert sg90.resolution == pytest.approx(count * microsecond)
    assert sg90.center == round(1500 / count)  # which is 1.5 ms
    assert (sg90.command_rate, sg90.signal) == (50.0, "pulse")


@pytest.mark.parametrize(
    "name", [n for n, k in KNOWN_SERVOS.items() if k.signal == "bus"]
)
def test_a_bus_servo_s_counts_divide_its_range(name):
    kind, sheet = KNOWN_SERVOS[name], shipped_tables("models.description", "makes.toml")
    given = sheet[name]
    count = np.deg2rad(given["degrees"]) / given["counts"]
    assert kind.resolution == pytest.approx(count)
    assert kind.center == given["counts"] // 2
    assert kind.reach == pytest.approx(np.deg2rad(given["degrees"]) / 2)
    assert kind.command_rate == given.get("command_rate", 100.0)
    for counts, angle in (("dead_counts", "dead_band"), ("full_counts", "full_error")):
        if counts in given:
            assert getattr(kind, angle) == pytest.approx(given[counts] * count)


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        (
            "pulse",
            {},
            "it has no stall_torque and no no_load_speed; give what its data",
        ),
        (
            "bus",
            {"stall_torque": 1.0},
            "it has no no_load_speed; give what its data sheet says",
        ),
        ("no-such", {}, "it "),
        ("sg90", {"volt": 5.0}, "a servo has no 'volt'; did you mean 'volts'"),
        ("sg90", {"command_rate": 1e-320}, "command_rate = .* is of no servo; correct"),
        ("sg90", {"center": -1.1e6}, "center = -1.1e.06 is of no servo; correct it"),
        ("sg90", {"center": nan}, "center = nan is of no servo; correct it"),
    ],
)
def test_servos_without_a_make_need_torque_and_speed(name, given, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        servo_of(name, given)
    assert servo_of("pulse", {"stall_torque": 1.5, "no_load_speed": 6.0})
    assert servo_of("sg90") is not None


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        *((n, v, f"{n} must be positive and finite, got {v}")
          for n in ("stall_torque", "no_load_speed", "full_error", "reach")
          for v in (0.0, -1.0, inf)),
        *((n, v, f"{n} must not be negative: {v}")
          for n in ("command_rate", "resolution", "dead_band", "backlash", "volts")
          for v in (-1e-9, inf)),
    ],
)  # fmt: skip
def test_servos_that_cannot_be_are_refused(name, value, message):
    good = ServoKind(stall_torque=1.0, no_load_speed=6.0, full_error=0.1)
    with pytest.raises(ValueError, match=f"^{message}$"):
        replace(good, **{name: value})
    if value < 0:
        replace(good, **{name: 1e-9})


def test_counts_of_pulses_are_finer_at_a_higher_rate_and_those_of_a_bus_are_not():
    pulse = ServoKind(
        stall_torque=2.0, no_load_speed=5.0, full_error=0.1, command_rate=50.0,
        resolution=0.004, center=307,
    )  # fmt: skip
    faster = pulse.at_rate(100.0)
    assert (faster.resolution, faster.center, faster.command_rate) == (0.002, 614, 100)
    for kind, rate in (
        (replace(pulse, signal="bus"), 100.0),
        (pulse, 0.0),
        (replace(pulse, command_rate=0.0), 100.0),
    ):
        same = kind.at_rate(rate)
        assert (same.resolution, same.center, same.command_rate) == (0.004, 307, rate)


def test_another_rate_on_a_card_changes_counts_of_pulses_and_not_the_pulses():
    """They would turn real servos to other angles."""
    made = KNOWN_SERVOS["mg90"]
    faster = made.with_numbers({"command_rate": 2 * made.command_rate})
    assert (faster.center, faster.resolution) == (2 * made.center, made.resolution / 2)
    given = made.with_numbers(
        {"command_rate": 100.0, "center": 600, "resolution": 0.002}
    )
    assert (given.center, given.resolution) == (600, 0.002)  # of frames at that rate


def test_another_voltage_alone_changes_torque_and_speed():
    sheet = ServoKind(stall_torque=2.0, no_load_speed=5.0, full_error=0.1, volts=5.0)
    weak = sheet.with_numbers({"volts": 4.0, "center": 12.6})
    assert (weak.stall_torque, weak.no_load_speed) == pytest.approx((1.6, 4.0))
    assert (weak.volts, weak.center, weak.full_error) == (4.0, 13, 0.1)
    given = sheet.with_numbers({"volts": 4.0, "stall_torque": 1.9})
    assert (given.stall_torque, given.no_load_speed) == pytest.approx((1.9, 4.0))
    unknown = replace(sheet, volts=0.0).with_numbers({"volts": 4.0})
    assert (unknown.stall_torque, unknown.no_load_speed) == (2.0, 5.0)


def test_a_servo_s_stiffness_loss_and_rotor_follow_from_its_numbers():
    kind = ServoKind(stall_torque=2.0, no_load_speed=5.0, full_error=0.1)
    assert kind.stiffness == 20.0
    assert kind.lost_torque == pytest.approx(0.4)
    assert kind.rotor == pytest.approx(0.4 * START_UP)
    assert replace(kind, armature=0.03).rotor == 0.03


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"channel": -1}, "channel must not be negative, got -1"),
        ({"center": inf}, "center must not be negative, got inf"),
        ({"sign": 0.5}, "sign must be 1 or -1, got 0.5"),
        ({"offset": inf}, "offset must be finite, got inf"),
        ({"counts_per_radian": 0.0}, "counts_per_radian must be positive, got 0.0"),
        ({"counts_per_radian": inf}, "counts_per_radian must be positive, got inf"),
        *(({"limits": pair}, "limits are the lowest and the highest angle, got ")
          for pair in ((1, 1), (1, 0), (-inf, 1), (0, inf), (0, 1, 2))),
    ],
)  # fmt: skip
def test_joint_servos_that_cannot_be_are_refused(given, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        JointServo(**given)
    JointServo(channel=0, center=0, sign=-1, counts_per_radian=1e-9, limits=(-1, 1))


def test_servos_on_pulses_take_commands_at_a_rate():
    """A board divides its clock by it."""
    with pytest.raises(ValueError, match="command_rate must be positive for servos on"):
        servo_of("mg90", {"command_rate": 0.0})
    assert servo_of("ax-12", {"command_rate": 0.0}).command_rate == 0.0
