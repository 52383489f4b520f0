"""Replanning makes good what an imperfect robot misses, before it misses it."""

from math import radians

import numpy as np
import pytest

from sim.errors import UsageError
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import Scenario
from sim.walking.walks import Walker, carry_out

BENT = {"zero_offset": radians(1.0), "slope": [0.03, 1.0], "draw": 2}


def test_it_learns_of_itself_on_imperfect_robots_alone(scenario):
    found = [
        prepare(scenario(replan=True, **changes)).learns
        for changes in ({}, BENT, {"learn": True}, BENT | {"learn": False})
    ]
    assert found == [False, True, True, False]
    assert not prepare(scenario(**BENT)).learns  # open loop


@pytest.fixture(scope="module")
def walks():
    """The same way with what was learned and without, 4 mm a segment."""

    def walked(learn):
        way = {"path": line((0.02, 0.0, 0.0)), "segments": 5, "replan": True}
        setup = prepare(Scenario(name="bent", learn=learn, **way, **BENT))
        walker = Walker(setup)
        return walker, carry_out(walker, None)

    return {learn: walked(learn) for learn in (True, False)}


@pytest.mark.physics
def test_a_bent_robot_on_a_slope_arrives_once_it_has_learned_what_it_misses(walks):
    def off(learn):
        return float(np.hypot(*(walks[learn][0].pose[:2] - (0.02, 0.0))))

    # measured 0.015 mm with and 0.30 mm without what was learned
    assert off(learn=True) < 0.1e-3
    assert off(learn=False) > 2 * off(learn=True)


@pytest.mark.physics
def test_a_segment_is_aimed_aside_by_what_segments_before_missed(walks):
    """The first stroke is planned as ever; the next segments are not."""
    plain, learned = (
        [
            np.array([p.amount for p in stretch.schedule.phases if p.kind == "swing"])
            for stretch in walks[learn][1].stretches[1:]
        ]
        for learn in (False, True)
    )
    assert plain[0][0] == learned[0][0]
    assert len(plain[1]) != len(learned[1]) or (plain[1] != learned[1]).any()


@pytest.mark.physics
def test_what_one_walk_has_learnt_another_begins_with(walks, tmp_path):
    walker, walk = walks[True]
    (tmp_path / "learnt.toml").write_text(str(walk.followed.learnt))
    table = {"learnt": str(tmp_path), "replan": True, "learn": True}
    begun = prepare(load_scenario("line", table)).feedback()
    assert begun.bias == pytest.approx(walk.followed.feedback.bias, abs=1e-15)
    assert walks[False][1].followed.learnt is None


def test_what_another_robot_has_learnt_is_refused(tmp_path):
    """Its numbers are in metres and radians of that robot's segments."""
    numbers = f"[learnt]\nnumbers = {[0.0] * 15}\n"
    (tmp_path / "learnt.toml").write_text(numbers)
    (tmp_path / "scenario.toml").write_text('robot = "octopod"\n')
    with pytest.raises(UsageError, match="what octopod has learnt is of no use to an"):
        load_scenario("line", {"learnt": str(tmp_path)})
    own = {"learnt": str(tmp_path), "robot": "octopod", "replan": True}
    assert [*load_scenario("line", own).learnt] == [0.0] * 15
    (tmp_path / "scenario.toml").write_text('robot = "robot/mine.xml"\n')
    with pytest.raises(UsageError, match="what robot/mine.xml has learnt is of no use"):
        load_scenario("line", own)
    own["robot"] = "elsewhere/mine.xml"
    with pytest.raises(UsageError, match="of no use"):
        load_scenario("line", own | {"geometry": {"kappa": 0.5}})
    assert [*load_scenario("line", own).learnt] == [0.0] * 15


def test_what_is_not_learnt_is_refused(tmp_path):
    (tmp_path / "learnt.toml").write_text("[learnt]\nnumbers = [1.0]\n")
    table = {"learnt": str(tmp_path / "learnt.toml"), "replan": True, "learn": True}
    setup = prepare(load_scenario("line", table))
    with pytest.raises(UsageError, match="90 numbers are needed, got 1: learnt"):
        setup.feedback()
    (tmp_path / "learnt.toml").write_text("x = 1\n")
    with pytest.raises(UsageError, match=r"no \[learnt\] table with numbers: "):
        load_scenario("line", {"learnt": str(tmp_path)})
