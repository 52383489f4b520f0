"""Directions that the swings of a robot give, and the reason why others are missing."""

import pytest

from models.adoption.draft import propose
from models.library import load
from models.motion.robot_equations import equations, mobility_of
from tests import radial


def of(robot):
    return mobility_of(robot, equations(robot))


def test_hexapod_goes_everywhere(hexapod):
    found = of(hexapod)
    assert (found.lacking, found.reason) == ((), "")
    assert [cost.direction for cost in found.costs] == ["x", "y", "theta"]
    # a swing of 0.9 rad moves it by 0.0378 m/rad; each has its recovery
    assert found.costs[0].strokes == pytest.approx(2 / (0.9 * 0.0378))


@pytest.mark.parametrize("digits", [12, 5])
def test_pivots_in_one_point_let_a_robot_only_turn_however_it_is_rounded(
    digits, tmp_path
):
    found = of(load(str(radial.write(tmp_path, digits))))
    assert found.lacking == ("go forward", "go sideways")
    assert "(0.000, 0.000) m" in found.reason
    assert "pivots are" in found.reason


@pytest.mark.parametrize(
    ("claim", "lacking"),
    [
        ("[1e-7, 0.0, 0.5]", ("go forward", "go sideways")),
        ("[0.1, 0.0, 0.0]", ("go sideways", "turn")),
    ],
    ids=["strides of a tenth of a micrometre", "parallel legs"],
)
def test_strokes_that_are_short_or_straight_leave_directions_out(
    claim, lacking, edited
):
    robot = edited(
        "[group.1]", f"[group.1]\ntwist = {claim}",
        "[group.2]", f"[group.2]\ntwist = {claim}",
    )  # fmt: skip
    assert of(robot).lacking == lacking


def test_proposed_posture_goes_everywhere(tmp_path):
    proposal = propose(load(str(radial.write(tmp_path))))
    turned = int(proposal.split("up to ")[1].split()[0])
    assert 0 < turned <= 26  # degrees, within the range of the joints
    assert "strokes a metre sideways" in proposal


def test_the_search_for_a_proposal_ends_in_time(tmp_path, monkeypatch):
    """Forty legs have 550 billion pairs of groups."""
    monkeypatch.setattr("models.adoption.draft.PROPOSING", 0.0)
    assert propose(load(str(radial.write(tmp_path)))) == ""


def test_equal_robots_share_their_system_and_what_is_derived_from_it():
    hexapod, other = load("hexapod"), load("hexapod-radial")
    assert equations(hexapod).system is equations(load("hexapod")).system
    assert equations(hexapod).system is not equations(other).system
