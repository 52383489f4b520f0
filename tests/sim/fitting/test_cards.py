"""Cards that a fit writes are those that walks take."""

from dataclasses import replace

import pytest

from models import load
from models.description import parse_toml
from sim.errors import UsageError
from sim.fitting.fitting import card_text


def test_what_no_walk_takes_is_written_on_no_card():
    robot, zeros = load("hexapod"), [0.5] + [0.0] * 11
    with pytest.raises(UsageError) as found:
        card_text(robot, {"zero_offset": (zeros, zeros)}, ["a.csv", "b.csv"])
    assert found.value.what.startswith("zero_offset = [0.5, 0.0, ")
    assert found.value.where == "a.csv, b.csv"
    assert "calibrate the robot first" in found.value.remedy
    zeros[0] = 0.2
    assert "zero_offset = [0.2, " in card_text(
        robot, {"zero_offset": (zeros, zeros)}, []
    )


def test_a_card_can_be_read_whatever_its_logs_are_called():
    names = ["a\x7fb.csv", "d'e\"f.csv", "ü.csv"]
    zeros = [0.0] * 12
    text = card_text(load("hexapod"), {"zero_offset": (zeros, zeros)}, names, "mg90")
    assert parse_toml(text)["fitted"]["source"] == names
    assert parse_toml(text)["fitted"]["servo"] == "mg90"


HEADERS = ["[fitted]", "[fitted]  # on Monday", ' [ "fitted" ]', "\r\n[fitted]\r"]


@pytest.mark.parametrize("header", HEADERS)
def test_a_fit_takes_the_place_of_the_last_one_and_leaves_what_follows_it(header):
    robot, zeros = load("hexapod"), [0.0] * 12
    after = "[fitted.errors]\nfriction = 0.1\n[board]\nclock = 26e6\n"
    earlier = f"{robot.card_text}\n{header}\nfriction = 0.9\n{after}"
    text = card_text(
        replace(robot, card_text=earlier), {"zero_offset": (zeros, zeros)}, []
    )
    found = parse_toml(text)
    assert found["board"] == {"clock": 26e6}
    assert "friction" not in found["fitted"]
    assert found["fitted"]["errors"] == {"zero_offset": zeros}


def test_a_card_that_could_not_be_read_is_not_written():
    robot, zeros = load("hexapod"), [0.0] * 12
    dotted = replace(robot, card_text=f"fitted.friction = 0.9\n{robot.card_text}")
    with pytest.raises(UsageError, match="cannot be written, .*the line .fitted."):
        card_text(dotted, {"zero_offset": (zeros, zeros)}, [])
