"""check, systems and plan on systems, as a user meets them."""

import json
import math
import os
import re
from pathlib import Path

import pytest

from models.library import shipped_robots
from models.systems.catalogue import SYSTEMS
from sim import cli

LINE = """
state = ["x", "y"]
goal = { x = 1 }

[strata.0]
ahead = { x = 1 }
"""


@pytest.fixture
def stratawalk(capsys, tmp_path, monkeypatch):
    """Run a command in an empty folder: its exit code, and what it printed where."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.problems.problem.TRIAL_TIME", 0.0)  # tried in tests of it

    def run(*words):
        code = cli.main(words)
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run


@pytest.fixture
def facts(stratawalk):
    """The JSON that a command prints, which must succeed."""

    def run(*words):
        code, out, err = stratawalk(*words, "--json")
        assert (code, err) == (0, "")
        return json.loads(out)

    return run


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_system_is_checked_and_planned(facts, name):
    assert facts("check", name)["controllable"] is True
    planned = facts("plan", name, "--segments", "16")
    assert planned["error"] < planned["distance"]


@pytest.mark.parametrize("name", shipped_robots())
def test_every_robot_is_checked(facts, name):
    report = facts("check", name)
    assert report["controllable"] is True
    assert report["rank"] == report["dimension"]


def test_what_no_joint_range_can_use_is_controllable_in_theory_only(stratawalk):
    words = ("check", "paper-hexapod", "--set", "yaw_gain=1e-6")
    code, out, err = stratawalk(*words)
    assert (code, err) == (0, "")
    assert "in theory only: the joint ranges are too small to move along y" in out
    report = json.loads(stratawalk(*words, "--json")[1])
    assert report["controllable"] is False
    assert report["in_theory_only"] == ["y", "theta"]
    assert report["strokes"]["y"]["element"] == "[g12_1,g12_2]"


def test_uncontrollable_is_an_answer_and_not_an_error(stratawalk, tmp_path):
    (tmp_path / "line.toml").write_text(LINE)
    code, out, err = stratawalk("check", "line.toml")
    assert (code, err) == (0, "")
    assert "verdict     not controllable" in out
    assert "missing     y" in out
    assert "to do       give some stratum a field that moves along y" in out


def test_verdict_names_the_test_that_decided(stratawalk):
    _, out, _ = stratawalk("check", "biped")
    assert "verdict     controllable, as the closure shows" in out
    assert "filtration  rank 4 of 5" in out
    assert "closure     rank 5 of 5" in out


def test_depth_too_small_is_said_to_be_no_answer(stratawalk):
    _, out, _ = stratawalk("check", "hexapod-trailer", "--depth", "2")
    assert "verdict     not shown to be controllable" in out
    assert "form brackets beyond degree 2" in out


def test_another_gait_and_configuration_can_be_checked(facts):
    report = facts("check", "biped", "--gait", "12", "1", "12", "--at", "theta=1")
    assert report["gait"] == "S12 -> S1 -> S12"
    assert report["at"][2] == 1
    assert not report["controllable"]
    assert "visit S2" in report["advice"]


def test_replanned_system_meets_its_goal(facts):
    assert facts("plan", "biped", "--replan")["error"] < 1e-9  # what aiming promises


def test_goal_start_segments_elements_and_parameters_are_options(facts):
    planned = facts(
        *("plan", "paper-hexapod", "--set", "stride=2", "--segments", "3"),
        *("--start", "y=1", "--goal", "x=2", "theta=0.5"),
        *("--elements", "g1_1", "g2_2", "g1_2", "g2_1", "[g1_1,g2_2]"),
    )
    assert planned["segments"] == 3
    assert planned["elements"][0] == "g1_1"
    assert [planned["goal"][name] for name in ("x", "y", "theta")] == [2, 1, 0.5]
    assert planned["distance"] == pytest.approx(math.hypot(2, 0.5))


def test_coordinate_without_a_new_value_keeps_the_start_s(facts):
    goal = facts("plan", "car", "--start", "x=1", "--goal", "y=1", "--segments", "2")
    assert (goal["goal"]["x"], goal["goal"]["y"]) == (1, 1)


def test_saved_plan_is_played_again(facts):
    kept = facts("plan", "finger-gaiting", "--save", "turn.json", "--flows")
    played = facts("plan", "turn.json", "--flows")
    for told in ("timing", "accuracy", "steps", "helps"):
        del kept[told]  # of the planning, not of the plan
    assert played == {**kept, "system": "turn"}


def test_degree_and_words_are_options_and_tell_what_to_expect(facts):
    plain = facts("plan", "unicycle")
    higher = facts("plan", "unicycle", "--degree", "3", "--segments", "8")
    mirrored = facts("plan", "unicycle", "--words", "symmetric")
    orders = [f["accuracy"]["order"] for f in (plain, higher, mirrored)]
    assert orders == [0.5, 1, 1]
    assert mirrored["error"] < plain["error"] / 5
    assert mirrored["flow_count"] == plain["flow_count"]
    assert facts("plan", "heisenberg")["accuracy"]["order"] is None


def test_trailers_are_parked_exactly_in_chained_form(facts):
    exact = facts("plan", "car-trailers", "--goal", "y=0.5")  # two are on a page
    assert exact["error"] < 1e-6
    assert exact["elements"][:2] == ["ahead", "turn"]
    by_elements = facts("plan", "car-trailers", "--degree", "4")
    assert by_elements["elements"][:2] == ["drive", "steer"]


def test_gait_and_lifted_feet_are_options(facts):
    free = facts("plan", "biped", "--segments", "4")
    more = ("12", "1", "12", "2", "12", "1", "12")
    ordered = facts("plan", "biped", "--segments", "4", "--gait", *more)
    assert ordered["contact_switches"] > free["contact_switches"]
    lifted = facts("plan", "biped", "--start", "height_1=0.1", "--goal", "y=0.5")
    assert lifted["end"]["height_1"] == pytest.approx(0.1)  # as at the start
    down = facts("plan", "biped", "--goal", "y=0.5")
    assert (lifted["accuracy"], lifted["steps"]) == (down["accuracy"], down["steps"])


def test_critical_step_is_told_beside_the_segments(stratawalk, facts):
    short = facts("plan", "unicycle")["steps"]
    assert short == {"first": pytest.approx(1 / 16), "critical": None}  # twice serves
    whole = facts("plan", "unicycle", "--segments", "1")["steps"]
    assert whole["critical"] == pytest.approx(1.06, abs=0.01)  # measured
    assert facts("plan", "heisenberg")["steps"]["critical"] is None
    two = "plan", "unicycle", "--goal", "y=8", "--segments", "2"
    assert "sure to converge to the goal for steps up to 1.06" in stratawalk(*two)[1]
    arrived = facts("plan", "unicycle", "--segments", "1", "--replan")
    assert (arrived["steps"], arrived["accuracy"]) == (None, None)


def test_scenario_is_planned_to_the_degree_asked_for(facts):
    printed = facts("plan", "line", "--segments", "20")
    higher = facts("plan", "line", "--segments", "20", "--degree", "4")
    assert higher["accuracy"]["order"] == 2
    assert higher["error"]["position"] < printed["error"]["position"] / 20


def test_saved_plan_may_be_read_by_all_who_may_read_new_files(facts, tmp_path):
    umask = os.umask(0o022)
    try:
        facts("plan", "car", "--segments", "1", "--save", "car.json")
    finally:
        os.umask(umask)
    assert (tmp_path / "car.json").stat().st_mode & 0o777 == 0o644


def test_elements_are_chosen_to_serve_all_along_the_way(facts, tmp_path):
    """Beside x = 0, and so at both ends, the bracket is not needed."""
    fields = 'a = { x = 1 }\nb = { y = "x" }'
    text = LINE.replace("ahead = { x = 1 }", fields) + "[start]\nx = -1\n"
    (tmp_path / "pinched.toml").write_text(text)
    planned = facts("plan", "pinched.toml", "--goal", "x=1", "y=1")
    assert planned["elements"] == ["a", "b", "[a,b]"]


def test_user_s_file_is_planned_and_checked(facts, tmp_path):
    (tmp_path / "wheel.toml").write_text(
        LINE.replace("ahead = { x = 1 }", 'a = { x = 1 }\nb = { y = "x" }')
    )
    assert facts("check", "wheel.toml")["controllable"]
    planned = facts("plan", "wheel.toml", "--goal", "y=1")
    assert planned["elements"] == ["a", "b", "[a,b]"]
    assert planned["error"] < 1e-9  # nilpotent


def test_list_of_systems_has_parameters(facts):
    systems = {system["name"]: system for system in facts("systems")}
    assert systems.keys() == SYSTEMS.keys()
    assert systems["chained"]["parameters"] == {"size": 5}


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (
            "plan biped --gait 12 7 12",
            2,
            "'7' of gait S12 -> S7 -> S12 is",
        ),
        (
            "plan biped --gait 1 12 1",
            2,
            "gait of biped starts in S1: ",
        ),
        (
            "plan octopd",
            2,
            "unknown scenario or system 'octopd': SCENARIO; did you mean",
        ),
        (
            "check hexapd",
            2,
            "unknown robot or system 'hexapd': ROBOT; did you mean 'he",
        ),
        ("plan gone.py", 2, "no such system file: gone.py; give a file that exists"),
        ("check gone.toml", 2, "no such system file: gone.toml"),
        ("check gone.xml", 2, "no such robot file: gone.xml"),
        ("plan gone.json", 6, "gone.json"),
        ("plan car --robot hexapod", 2, "--robot is for robots: car; leave it out"),
        (
            "plan line --goal x=1",
            2,
            "--goal is for systems: line; write --set 'path.go",
        ),
        ("plan line --out x.png", 2, "--out is for systems: line; walk it, and draw"),
        ("plan car --out x.txt", 2, "not a picture's name: x.txt; give a name in"),
        ("plan car --goal x=1e308", 2, "x = 1e.308: car; give one below 1e.100"),
        ("plan car --goal z=1", 2, "goal has z, which is unknown: car; there are x,"),
        ("plan car --goal z", 2, "'z' gives no value: --goal; write NAME=VALUE"),
        (
            "plan car --elements drive stear",
            2,
            "is unknown: car; did you mean 'steer",
        ),
        ("plan car --elements drive", 4, "no plan: .* nothing along y, theta, phi"),
        ("plan car --set lenght=1", 2, "lenght is unknown; did you mean 'length'?"),
        ("plan car --segments 0", 2, "segments is 0: car; a whole number from 1 to"),
        ("plan finger-gaiting --segments 3", 4, "plan at least 7 segments"),
        ("check hexapod --set radius=1", 2, "a robot has no parameters: --set"),
        ("check car --depth 0", 2, "depth is 0: car; at least 1 is needed"),
        ("check car --at x=y", 2, "'x=y' gives no value: --at"),
        ("plan car --set length=1 --set length=2", 2, "given twice: --set length"),
        ("check car --at x=1 x=2", 2, "x is given twice: --at; keep one of them"),
        (
            "check biped --gait 12 1",
            2,
            "does not close: .* in S1: --gait; end it in S12",
        ),
        ("check biped --gait S12 S7 S12", 2, "is unknown: --gait; there are 12, 1, 2"),
        ("plan line --save x.json", 2, "--save is for systems: line; leave it out"),
        ("plan line --elements g1", 2, "--elements is for systems: line; set a scenar"),
        (
            "plan car --save gone/x.json",
            6,
            "No such file or directory: gone/x.json; ch",
        ),
        ("plan car --save .", 2, "already exists: \\.; give --save another name"),
        ("run mine.toml", 2, "a system of strata is no scenario: mine.toml; plan or"),
        ("plan begun.toml", 2, "bad system: begun.toml; strata is missing"),
    ],
)
def test_refusal_is_one_line_and_a_code(stratawalk, words, code, said):
    Path("mine.toml").write_text(LINE)
    Path("begun.toml").write_text('state = ["x"]\ngoal = { x = 1 }')
    ended, out, err = stratawalk(*words.split())
    assert (ended, out) == (code, "")
    (line,) = err.splitlines()
    assert line.startswith("stratawalk: error: ")
    assert re.search(said, line)
