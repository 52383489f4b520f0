"""Servos of which a card says something before, or while, they are calibrated."""

import pytest

from models import load
from tests.sim.export.test_calibration import (
    Board,
    calibrate,  # noqa: F401 (a fixture)
    found,
    stranger,
    told_of,
)


@pytest.mark.parametrize("found", ["channel", "joint"])
def test_what_the_card_has_got_meanwhile_is_not_found_once_more(
    calibrate,  # noqa: F811
    capsys,
    found,
):
    card, board = stranger(), Board(1)
    first, least = board.joints[board.channel.argmin()], board.channel.min()
    joint, channel = ("lift_1", least) if found == "channel" else (first, 15)
    owner, other = board.owner(), f"\n[servo.{joint}]\nchannel = {channel}\n"

    def answer(question):
        if "mark 2: " not in question and "mark 2 " in question:
            card.write_text(stranger_text + other)
        return owner(question)

    stranger_text = card.read_text()
    assert calibrate(answer, "own.xml") == 2
    assert "or its channel was given away meanwhile" in told_of(capsys)
    assert card.read_text() == stranger_text + other


def test_a_servo_of_which_only_limits_are_known_is_asked_for_and_keeps_them(
    calibrate,  # noqa: F811
    capsys,
):
    board, below = Board(1), "[servo.lift_2]\nlimits = [-0.6, 0.9]\n"
    card = stranger(below)
    assert found("own.xml")[1].assumed
    assert calibrate(None, "own.xml", "--check") == 2
    assert "no servo for joint" in told_of(capsys)
    assert calibrate(board.owner(), "own.xml") == 0
    servo = load("own.xml").card.joint_servos["lift_2"]
    assert servo.channel == board.channel[board.joints.index("lift_2")]
    assert servo.limits == (-0.6, 0.9)
    assert "clock = " in card.read_text()
    assert not found("own.xml")[1].assumed
