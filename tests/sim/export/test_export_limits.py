"""What boards, buses and packed headers have room for."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.description.servos import (
    BOARD_CLOCK,
    BOARD_COUNTS,
    DIVIDERS,
    PULSES,
    board_rate,
)
from sim.commands import export
from sim.errors import UsageError
from sim.export import served, source
from sim.export.header import FIRST, LONGEST_RUN, pack, unpack
from sim.export.ros_table import read_ros_table
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import FRAMES, Channel, ServoTable

COUNTS = np.cumsum(
    [[0] * 7, [31] * 7, [-31] * 7, [32] * 7, [4095 - 32] * 7, [0, 1, 0, 0, 0, 0, 0]],
    axis=0,
)


def table(channel=1, **changes):
    servo = Channel("hip", channel, 1.0, 2048.0, 0.0, 1000.0, -0.5, 0.5)
    return ServoTable(**{"channels": (servo,), "largest": 4095} | changes)


@pytest.mark.parametrize("held", [1, LONGEST_RUN, LONGEST_RUN + 1, 500])
def test_digits_of_a_packed_header_have_six_bits(held):
    counts = np.repeat(COUNTS, held, axis=0)
    packed = pack(counts)
    digits = [ord(letter) - FIRST for letter in packed]
    assert min(digits) >= 0
    assert max(digits) < 2**6
    assert unpack(packed, 7).tolist() == counts.tolist()


def test_small_changes_take_a_digit_and_larger_ones_four():
    rests = len(pack(np.zeros((1, 1), dtype=int)))
    sizes = [len(pack(np.array([[0], [to]]))) - rests for to in (31, -31, 32, -32)]
    assert sizes == [3, 3, 6, 6]  # with how long it is held, and which joints change


def test_a_board_gives_frames_as_fast_as_its_dividers_let_it():
    ends = [BOARD_CLOCK / BOARD_COUNTS / divider for divider in reversed(DIVIDERS)]
    assert [round(rate) for rate in ends] == [*FRAMES]
    assert board_rate(1.0) == pytest.approx(ends[0])


@pytest.mark.parametrize(("rate", "most"), [(50.0, 255), (0.0, 253)])
def test_channels_fit_a_byte_on_boards_and_the_numbers_of_a_bus(rate, most):
    assert table(most, frame_rate=rate).channels[0].channel == most
    with pytest.raises(UsageError, match=f"number them from 0 to {most}"):
        table(most + 1, frame_rate=rate)


def test_servos_are_on_a_bus_and_described_unless_that_is_said():
    assert table() == table(frame_rate=0.0, microseconds=False, assumed=False)


@pytest.mark.parametrize(("beyond", "taken"), [(0.9e-9, True), (1.1e-9, False)])
def test_servos_turn_to_their_limits_but_for_rounding(beyond, taken):
    commands = ServoCommands(("hip",), 50.0, np.array([[-0.5 - beyond], [0.5]]))
    if taken:
        assert table().require_range(commands).shape == (2, 1)
    else:
        with pytest.raises(UsageError, match="hip"):
            table().require_range(commands)


def test_a_table_of_ros_has_a_hundred_kilobytes_at_most(tmp_path):
    numbers = "id: 1, ticks: 4096, center: 2048, max_radians: 6.28, sign: 1, offset: 0"
    text = f"hip: {{name: hip, {numbers}}}\n"
    for size, refusal in ((100_000, None), (100_001, "larger than 0.1 MB")):
        path = tmp_path / f"{size}.yaml"
        path.write_text(text + "#" * (size - len(text)))
        if refusal is None:
            assert [*read_ros_table(path)] == ["hip"]
        else:
            with pytest.raises(UsageError, match=refusal):
                read_ros_table(path)


def test_servos_without_a_rate_get_commands_as_hobby_servos_do():
    assert (served.SERVO_RATE, export.RATE) == (PULSES, PULSES)


def test_commands_are_read_from_files_of_a_gigabyte_at_most(monkeypatch):
    class AskedError(Exception):
        """How large the file may be."""

    def read_text(path, largest):
        raise AskedError(largest)

    monkeypatch.setattr(source, "read_text", read_text)
    with pytest.raises(AskedError, match="^1000000000$"):
        source.read("commands.csv", "csv", table())


@pytest.mark.parametrize(
    ("limited", "farthest"), [(True, 0.5 + 0.5), (False, 4 * np.pi + 0.5)]
)
@pytest.mark.parametrize(("off", "taken"), [(-0.01, True), (0.01, False)])
def test_commands_are_ahead_of_what_a_joint_can_by_half_a_radian_at_most(
    limited, farthest, off, taken, monkeypatch
):
    """And joints that turn without end by two turns from the middle."""
    commands = ServoCommands(("hip",), 50.0, np.array([[0.0], [farthest + off]]))
    monkeypatch.setattr(source, "taken", lambda *_: commands)
    monkeypatch.setattr(source, "actuators_driving", lambda *_: (0,))
    joint = SimpleNamespace(limited=limited, range=(-0.5, 0.5))
    run = SimpleNamespace(commands={"ctrl": None}, folder="runs/it")
    given = SimpleNamespace(
        run=run, servo=SimpleNamespace(rate=0.0), joints=("hip",),
        timestep=0.001, model=SimpleNamespace(joint=lambda name: joint),
    )  # fmt: skip
    if taken:
        assert source.Source.commands(given, 50.0) is commands
    else:
        with pytest.raises(UsageError, match="'hip' is commanded from 0 to"):
            source.Source.commands(given, 50.0)
