"""Plans that end far off their goal say what would help, having tried it."""

import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.errors import BoundError, PlannerError
from planner.support.stopping import tick
from sim import cli
from sim.planning.open_loop import unaimed
from sim.preparation.setup import prepare
from sim.problems.problem import tried
from sim.problems.scenario import miss_of
from sim.problems.system import SystemProblem
from sim.scenarios.file import load_scenario
from tests import radial

SHORT = ("--segments", "1", "--set", "path.goal=[0.02, 0.02, 0]")


@pytest.fixture
def stratawalk(capsys):
    def run(*words):
        code = cli.main(words)
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run


@pytest.fixture
def facts(stratawalk):
    def run(*words):
        code, out, err = stratawalk("plan", *words, "--json")
        assert (code, err) == (0, "")
        return json.loads(out)

    return run


def share(planned):
    return planned["error"] / planned["distance"]


def test_what_is_said_to_help_a_system_helps_it_as_much(facts):
    far = facts("unicycle", "--segments", "4")
    assert share(far) > 0.2
    said = re.findall(r"(--\w+(?: \w+)?) ends (\S+) % off", far["helps"])
    assert len(said) == 3
    for option, percent in said:
        words = dict([("--segments", "4"), (option.split() + [None])[:2]])
        flat = [word for pair in words.items() for word in pair if word]
        assert 100 * share(facts("unicycle", *flat)) == pytest.approx(
            float(percent), rel=0.06, abs=1e-6
        )


def test_what_is_said_to_help_a_robot_helps_it_as_much(facts):
    far = facts("line", "--robot", "quadruped", *SHORT)
    assert far["error"]["position"] > 0.1 * far["path_length"]
    percent = float(re.search(r"--degree 3 ends (\S+) % off", far["helps"])[1])
    cured = facts("line", "--robot", "quadruped", *SHORT, "--degree", "3")
    assert cured["helps"] == ""
    assert 100 * cured["error"]["position"] / cured["path_length"] == pytest.approx(
        percent, rel=0.06
    )


def test_what_is_said_to_help_a_replanned_robot_is_replanned_too(facts):
    replan = ("line", "--replan", "--set", "path.goal=[0.1, 0.1, 0]")
    far = facts(*replan, "--segments", "1")
    assert far["error"]["position"] > 0.5 * far["path_length"]
    percent = float(re.search(r"--segments 4 ends (\S+) % off", far["helps"])[1])
    assert "--replan" not in far["helps"]
    cured = facts(*replan, "--segments", "4")
    assert 100 * cured["error"]["position"] / cured["path_length"] == pytest.approx(
        percent, rel=0.06
    )


def test_a_plan_that_arrives_is_left_alone(stratawalk):
    assert "helps" not in stratawalk("plan", "line", *SHORT, "--segments", "2")[1]


def test_coordinates_that_end_at_zero_are_shown(stratawalk):
    assert "ends at   x -0.4597, y 0.8415, theta 0.0000\n" in stratawalk(
        "plan", "unicycle", "--segments", "1"
    )[1]  # fmt: skip


@pytest.mark.parametrize("digits", [12, 5])
def test_robot_that_can_only_turn_is_told_so_and_not_to_widen_its_range(
    digits, stratawalk, tmp_path
):
    robot = str(radial.write(tmp_path, digits))
    short = (*SHORT, "--set", "plan_time=20")  # takes 1 where alone
    code, out, err = stratawalk("plan", "line", "--robot", robot, *short)
    assert (code, out) == (4, "")
    assert "no plan, since it cannot go forward or go sideways: radial; both" in err
    assert "strokes a metre sideways" in err
    assert "widen" not in err


def test_yaw_counts_as_the_way_of_the_feet(scenario):
    setup = prepare(scenario())
    off = miss_of(setup, np.array([0.01, 0.01, 0.01]), np.array([0.01, 0.01, 0.0]))
    feet = setup.kinematics.standing.feet
    arm = np.linalg.norm(feet, axis=1).mean()
    assert off == pytest.approx(0.01 * arm / math.hypot(0.01, 0.01))


def test_trials_end_with_their_time_and_pass_over_what_has_no_plan():
    def refused():
        raise PlannerError("none")

    def slow():
        while True:
            tick()

    offers = [("a", refused), ("b", lambda: 0.2), ("c", slow), ("d", lambda: 0.0)]
    trials = tried(offers, 1.0, 0.05)
    assert list(trials.helpful) == ["b"]
    assert trials.useless == ("a",)
    assert str(tried([("a", refused)], 1.0, 1.0)) == "nothing that was tried: a"


def test_a_system_whose_search_fails_keeps_its_stratified_plan(monkeypatch):
    def refused(self):
        raise BoundError("no plan was found")

    monkeypatch.setattr(SystemProblem, "shortest", refused)
    problem = SystemProblem(shipped_system("unicycle"), objective="time")
    solved = problem.solve()
    assert solved.fallback == "no plan was found"
    assert solved.plan.flows == problem.stratified.flows


@pytest.mark.parametrize("fields", ["paper", "lifted"])
def test_a_plan_that_steering_does_not_bring_home_is_told_other_fields(fields):
    """On fields of the paper standing feet drag; on lifted ones none has to."""
    told = replace(load_scenario("line"), fields=fields, steer="compliant")
    error = str(unaimed(SimpleNamespace(scenario=told), "the plan", 0.283))
    assert "the plan still misses its end by 283 mm or mrad" in error
    assert "steered by the compliant prediction" in error
    assert ("--set fields=lifted, so that no foot has to" in error) == (
        fields == "paper"
    )


@pytest.mark.parametrize(("segments", "told"), [("1", True), ("2", False)])
def test_what_replanning_does_to_a_single_segment_is_told(stratawalk, segments, told):
    code, out, _ = stratawalk("plan", "unicycle", "--segments", segments)
    assert code == 0
    assert "--replan ends" in out
    said = "--replan searches inputs with which the segment itself ends at the goal"
    assert (said in out) is told
