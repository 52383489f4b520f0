"""Scenarios that a program asks for, with the values that programs have at hand."""

from pathlib import Path

import numpy as np
import pytest

from sim.errors import UsageError
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import drawn


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({"path.goal": np.array([0.1, 0, 0])}, {"path.goal": [0.1, 0, 0]}),
        ({"friction": np.array(0.5)}, {"friction": 0.5}),
        ({"segments": np.int64(4)}, {"segments": 4}),
        (
            {"path": {"kind": "line", "goal": np.array([0.1, 0, 0])}},
            {"path": {"kind": "line", "goal": [0.1, 0, 0]}},
        ),
    ],
)
def test_arrays_are_taken_as_lists_of_their_numbers(changes, same):
    assert load_scenario("line", changes) == load_scenario("line", same)


def test_a_key_that_is_no_text_is_unknown():
    with pytest.raises(UsageError, match="unknown key '1'"):
        load_scenario("line", {1: 2})


def test_a_scenario_may_be_named_by_a_path(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('segments = 3\n[path]\nkind = "line"\ngoal = [0.1, 0.0, 0.0]\n')
    assert load_scenario(file) == load_scenario(str(file))
    assert load_scenario(Path("line")) == load_scenario("line")


def test_hobby_robots_fill_what_is_said_of_them_and_no_more(hexapod):
    """Of 100 draws the outermost come within 5 % of each bound."""
    found = [
        drawn(load_scenario("line", {"imperfect": "hobby", "draw": n}), hexapod)
        for n in range(100)
    ]
    steep, toward = np.array([one.slope for one in found]).T
    off = np.array([one.payload[1:3] for one in found])
    rubs = np.array([one.foot_friction for one in found])
    for values, low, high in (
        (off, -0.01, 0.01),
        (np.degrees(steep), 0, 1),
        (toward, -np.pi, np.pi),
        (rubs, 0.6, 1.0),
    ):
        assert low <= values.min() < low + 0.05 * (high - low)
        assert high - 0.05 * (high - low) < values.max() <= high
    mass = hexapod.model.body_mass.sum()
    assert [*{one.payload[0] for one in found}] == [pytest.approx(mass / 20)]
    servos = {(one.zero_offset, one.backlash, one.floor_stiffness) for one in found}
    assert servos == {(np.radians(0.5), np.radians(0.5), 1e4)}
