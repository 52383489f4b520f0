"""`stratawalk design`: designs are checked, and those that go everywhere walked."""

import json

import pytest

from models.errors import ModelError
from sim.cli import main
from sim.studies import designing
from sim.studies.designing import DIRECTIONS, designs, directions


def test_the_quick_test_knows_the_shipped_design_and_one_that_cannot(hexapod):
    named = {str(design): design for design in designs(hexapod.legs)}
    shipped, one_way = named["1+ 4+ 5+ | 2+ 3+ 6+"], named["1+ 2+ 30 | 4+ 50 60"]
    assert directions(hexapod, shipped, {}) == DIRECTIONS
    assert directions(hexapod, one_way, {}) == ()


@pytest.mark.physics
def test_two_swing_joints_suffice(capsys):
    words = ["design", "hexapod", "--designs", "90", "--walks", "1", "--json"]
    assert main(words) == 0
    rows = json.loads(capsys.readouterr().out)
    assert len(rows) == 90
    assert {row["swing_joints"] for row in rows} == {2}
    able = [row for row in rows if "strokes.y" in row and row["strokes.y"]]
    assert len(able) >= 1
    walked = [row for row in rows if row.get("min_margin") is not None]
    assert len(walked) == 1
    assert walked[0]["min_margin"] > 0


def test_a_robot_with_four_legs_is_refused(capsys):
    assert main(["design", "quadruped"]) == 2
    assert "4 legs are too few for two groups" in capsys.readouterr().err


def test_a_design_that_cannot_be_checked_says_why(hexapod, monkeypatch):
    def refused(robot, described):
        raise ModelError("no two groups of its legs can stand")

    monkeypatch.setattr(designing, "mobility_of", refused)
    assert designing._checked(hexapod) == {
        "status": "no two groups of its legs can stand"
    }
