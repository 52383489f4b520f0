"""plan on cars with trailers, which turn farther than one chart serves."""

import json

import numpy as np
import pytest

from sim import cli

CORNER = ("x=1", "y=1", "theta_0=1.5707963", "theta_1=1.5707963")


def test_a_trailer_is_brought_around_a_corner_and_the_plan_is_read_again(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    ends = []
    corner = ("car-trailers", "--goal", *CORNER, "--save", "corner.json")
    for words in (corner, ("corner.json",)):
        assert cli.main(["plan", *words, "--json"]) == 0
        planned = json.loads(capsys.readouterr().out)
        assert planned["error"] < 1e-9
        ends.append(planned["end"])
    assert ends[1] == pytest.approx(ends[0], abs=1e-12)


TRUCK = """state = ["x", "y", "heading", "steer", "hitch"]
goal = { y = 1 }
segments = 4
%s
[parameters]
L = 1.0
d = 0.8
[strata.0]
turn = { steer = 1 }
[strata.0.drive]
x = "cos(heading)*cos(steer)"
y = "sin(heading)*cos(steer)"
heading = "sin(steer)/L"
hitch = "-sin(steer)/L - sin(hitch)*cos(steer)/d"
"""
AXLE = 'flat = { along = "x - %s", across = "y - %s" }'


@pytest.fixture
def untried(monkeypatch):
    """Nothing is tried that might help, which takes longer than the plans."""
    monkeypatch.setattr("sim.problems.problem.TRIAL_TIME", 0.0)


@pytest.fixture
def plan(capsys, tmp_path):
    """The facts about a plan of a car with one trailer, or the refusal."""

    def run(*words, flat="", system=""):
        truck = tmp_path / "truck.toml"
        truck.write_text(TRUCK % flat)
        code = cli.main(["plan", system or str(truck), *words, "--json"])
        said = capsys.readouterr()
        return said.err if code else json.loads(said.out)

    return run


@pytest.mark.usefixtures("untried")
def test_trailers_that_fold_beyond_a_right_angle_are_warned_of(plan, capsys):
    hitched = 'hitches = ["hitch"]'
    folded = plan("--segments", "1", flat=hitched)["largest_fold"]
    assert folded > np.pi / 2
    assert plan("--goal", "y=0.01", flat=hitched)["largest_fold"] < np.pi / 2
    assert "largest_fold" not in plan("--segments", "1")  # nobody said what folds
    for segments, warned in (("1", True), ("16", False)):
        words = ["hexapod-trailer", "--goal", "y=1", "--segments", segments]
        assert cli.main(["plan", *words]) == 0
        said = capsys.readouterr().out
        assert ("warning   a trailer folds by up to " in said) is warned
        assert "\nhitches   bend by up to " in said


def test_what_converges_faster_is_offered_only_where_it_misses_less(plan):
    """Symmetric words turn the trailer right through the car."""
    found = plan()
    assert found["accuracy"]["faster"] == {}
    assert plan("--words", "symmetric")["error"] > found["error"]
    for segments, better in (("16", {"symmetric words": 1}), ("1", {})):
        few = plan("--segments", segments, system="unicycle")
        assert few["accuracy"]["faster"] == {**better, "degree 3": 1}


@pytest.mark.usefixtures("untried")
def test_flat_outputs_of_the_wrong_axle_are_told_the_right_one(plan):
    refused = plan(flat=AXLE % ("L*cos(heading)", "L*sin(heading)"))
    assert "turn changes their slope of order 1, and may change only that" in refused
    assert "take the middle of the last axle" in refused
    last = AXLE % ("d*cos(heading + hitch)", "d*sin(heading + hitch)")
    assert plan(flat=last)["error"] < 1e-9
