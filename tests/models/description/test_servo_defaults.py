"""What servos are that their data sheets and cards say nothing more of."""

from math import pi

import mujoco
import pytest

from models.description.card import LegCard, Servo
from models.description.compiled import check_model
from models.description.servos import JointServo, ServoKind, _kind, board_divider
from models.description.table import parse_toml
from models.errors import ModelError

PLAIN = ServoKind(stall_torque=1.2, no_load_speed=6.0, full_error=0.1)


@pytest.mark.parametrize(
    "imperfection",
    ["command_rate", "resolution", "center", "volts", "dead_band", "backlash",
     "profile_speed", "armature"],
)  # fmt: skip
def test_a_servo_without_numbers_has_no_imperfection(imperfection):
    assert getattr(PLAIN, imperfection) == 0


def test_a_rotor_of_unknown_inertia_starts_up_in_thirty_milliseconds():
    assert PLAIN.rotor == pytest.approx(0.03 * 1.2 / 6.0)


def test_joints_turn_as_their_servos_do_and_lift_as_they_turn():
    plain = JointServo()
    assert (plain.sign, plain.offset) == (1, 0.0)
    assert LegCard("a", "b", ("c",)).raise_sign == 1
    assert Servo(stiffness=10.0, damping=0.1).armature == 0


@pytest.mark.parametrize("key", ["stiffness", "damping"])
def test_a_make_has_a_stiffness_and_a_damping_of_its_own(edited, key):
    with pytest.raises(ModelError, match=f"kind 'mg90' gives {key}; leave {key} out"):
        edited("[gait]", f'[servo]\nkind = "mg90"\n{key} = 1.0\n\n[gait]')


def test_data_sheets_are_in_kilogram_force_centimetres_and_seconds_for_60_degrees():
    kind = _kind({"kgf_cm": 2.0, "seconds": 0.1, "full_error": 0.1})
    assert kind.stall_torque == pytest.approx(2.0 * 9.80665 * 0.01)
    assert kind.no_load_speed == pytest.approx(pi / 3 / 0.1)


def test_pulses_come_fifty_times_a_second_and_buses_are_taken_to_be_twice_as_fast():
    sheet = {"stall_torque": 1.0, "no_load_speed": 6.0, "full_error": 0.1}
    bus = _kind(sheet | {"counts": 1000, "degrees": 180})
    assert (bus.command_rate, bus.center, bus.signal) == (100.0, 500, "bus")
    assert bus.resolution == pytest.approx(pi / 1000)
    assert bus.reach == pytest.approx(pi / 2)
    pulse = _kind(sheet | {"degrees": 180, "dead_pulse": 4})
    assert pulse.command_rate == 50.0
    # a frame of 20 ms has 4096 counts, and 90 degrees are 1000 microseconds apart
    assert pulse.resolution == pytest.approx(20_000 / 4096 * pi / 2000)
    assert pulse.center == round(1500 / (20_000 / 4096))
    assert pulse.dead_band == pytest.approx(4 * pi / 2000)
    assert pulse.full_error == pytest.approx(3 * pulse.dead_band)


def test_a_board_divides_its_clock_of_25_megahertz_by_4_to_256():
    assert board_divider(1e6) == 4
    assert board_divider(1.0) == 256
    assert board_divider(50.0) == round(25e6 / 4096 / 50)


def test_whole_numbers_have_64_bits_at_most():
    assert parse_toml(f"a = {2**63 - 1}")["a"] == 2**63 - 1
    with pytest.raises(ValueError, match="more than 64 bits"):
        parse_toml(f"a = {2**63}")


@pytest.mark.parametrize(("count", "refused"), [(1000, False), (1001, True)])
def test_solvers_iterate_a_thousand_times_at_most(count, refused):
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    model.opt.iterations = count
    if refused:
        with pytest.raises(ModelError, match="1000"):
            check_model(model, "x")
    else:
        check_model(model, "x")
