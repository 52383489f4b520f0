"""Draws of an imperfect robot: repeatable, each in a run folder, told as a table."""

import csv
import json
from dataclasses import replace

import pytest

from models.library import load
from sim.cli import main
from sim.commands.walks import Try, describe, judged_tries
from sim.errors import UsageError
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import drawn
from sim.scenarios.settings import IMPERFECTIONS

SHORT = ["--set", "path.goal=[0.01,0.01,0]", "--segments", "2", "--no-video"]
SHORT += ["--set", 'predictions=["quasi_static"]']


@pytest.fixture(scope="module")
def robot():
    return load("hexapod")


def hobby(robot, draw):
    return drawn(load_scenario("line", {"imperfect": "hobby", "draw": draw}), robot)


def test_a_draw_is_the_same_whenever_it_is_drawn(robot):
    first, again, other = (hobby(robot, n) for n in (3, 3, 4))
    assert first == again
    assert first.payload != other.payload
    assert first.imperfect is None  # its values stand in the settings
    assert drawn(first, robot) == first


def test_predictions_know_nothing_of_what_is_drawn(robot):
    asked, plain = load_scenario("line", {"imperfect": "hobby"}), load_scenario("line")
    for scenario in (asked, drawn(asked, robot)):
        assert scenario.is_imperfect
        assert replace(scenario.as_planned, known=plain.known) == plain
    assert {"backlash", "dead_band", "command_delay"} <= {*IMPERFECTIONS}


def test_an_unknown_set_is_refused_with_those_known():
    with pytest.raises(UsageError, match="imperfect = 'hobbit' is not .*give hobby"):
        load_scenario("line", {"imperfect": "hobbit"})


@pytest.mark.parametrize(
    "words", ["run line", "plan line", "export line --format csv --out a"]
)
@pytest.mark.parametrize("given", ["learnt=[0.1]", "sense=tag", "sense_every=2"])
def test_what_only_stops_need_is_refused_where_a_walk_has_none(words, given, capsys):
    name = given.partition("=")[0]
    assert main([*words.split(), "--set", given]) == 2
    said = capsys.readouterr().err
    assert f"{name} is for walks that are replanned, and this one is not: scen" in said


@pytest.mark.physics
def test_every_draw_has_a_run_folder_and_a_row(tmp_path, capsys):
    out = tmp_path / "tries"
    words = ["run", "line", *SHORT, "--tries", "2", "--draw", "5", "--out", str(out)]
    assert main(words) == 0
    assert "2 of 2 draws walked to their end" in capsys.readouterr().out
    with (out / "tries.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["draw"] for row in rows] == ["5", "6"]
    for row in rows:
        folder = out / f"draw-00{row['draw']}"
        summary = json.loads((folder / "summary.json").read_text())
        assert float(row["goal"]) == summary["error"]["goal"]["position"]
        scenario = load_scenario(str(folder / "scenario.toml"))
        assert scenario.draw == int(row["draw"])
        assert scenario.zero_offset > 0


def test_median_and_worst_are_of_the_draws_that_walked():
    tries = [
        Try(0, "arrived", 0.001, 0.001, 0.001, 0.0, 0.04),
        Try(1, "drifted", 0.003, 0.003, 0.003, 0.0, 0.03),
        Try(2, "simulation diverged"),
    ]
    said = "\n".join(describe(tries, 0.2))
    assert "2 of 3 draws walked to their end" in said
    assert "draw 2: simulation diverged" in said
    (goal,) = (line for line in said.splitlines() if line.startswith("goal"))
    assert goal.split() == ["goal", "2.00", "mm", "1.00%", "3.00", "mm", "1.50%"]
    assert said.splitlines()[2].split() == ["distance", "from", "median", "worst"]
    assert said.splitlines()[-1].startswith("least margin ")


def judged(capsys, *tries, tolerance=0.25):
    code = judged_tries(tries, tolerance, "see the folder")
    return int(code), capsys.readouterr().err


def test_draws_end_with_the_code_of_the_worst(capsys):
    fine, far = Try(0, "arrived", 0.0, off=0.01), Try(1, "missed", 0.1, off=0.4)
    fell, none = Try(2, "fell", 0.1, off=0.4), Try(3, "simulation diverged")
    assert judged(capsys, fine, fine) == (0, "")
    code, said = judged(capsys, fine, far)
    assert code == 7
    assert "1 ended farther off" in said
    assert "at worst 40 % of the path, yaw included: 2 draws" in said
    assert judged(capsys, fine, far, tolerance=0.5) == (0, "")
    assert judged(capsys, far, fell)[0] == 4
    assert judged(capsys, far, none)[0] == 4
