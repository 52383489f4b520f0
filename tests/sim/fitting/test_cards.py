"""Cards that a fit writes are those that walks take."""

import pytest

from models import load
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
