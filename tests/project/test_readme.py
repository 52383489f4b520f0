"""The README tells the truth: its code runs, its commands, options and files exist."""

import argparse
import json
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from models.library import shipped_robots
from models.systems.catalogue import SYSTEMS
from sim.cli import COMMANDS, main, parser
from sim.evaluation.comparison import HEADER, PREDICTIONS
from sim.scenarios.file import load_scenario, shipped_scenarios

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


def command_lines():
    """The words of every `$ stratawalk ...` line, comments left out."""
    lines = (line for block in blocks("console") for line in block.splitlines())
    return [
        shlex.split(line[2:], comments=True) for line in lines if "$ stratawalk" in line
    ]


def options(command):
    """Options that a command of the parser knows."""
    (commands,) = (
        a for a in parser()._actions if isinstance(a, argparse._SubParsersAction)
    )
    return {
        word for a in commands.choices[command]._actions for word in a.option_strings
    }


@pytest.mark.parametrize("block", blocks("python"))
def test_every_python_block_runs(block):
    exec(compile(block, "README.md", "exec"), {})


@pytest.mark.parametrize("words", command_lines(), ids=" ".join)
def test_every_command_line_parses_and_names_what_is_shipped(words):
    given = parser().parse_args(words[1:])
    assert getattr(given, "scenario", None) in (*shipped_scenarios(), *SYSTEMS, None)
    assert getattr(given, "system", None) in (*shipped_robots(), *SYSTEMS, None)
    assert getattr(given, "robot", None) in (*shipped_robots(), None)


def test_every_option_exists():
    ours = {word for command in COMMANDS for word in options(command)}
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", README))
    assert named - ours == set()


def test_every_command_named_exists():
    assert set(re.findall(r"stratawalk ([a-z]+)", README)) <= set(COMMANDS)


def test_every_path_of_this_project_exists():
    named = re.findall(
        r"`((?:planner|models|sim|scripts|tests|docs)/[\w./-]*)`", README
    )
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    assert [path for path in (*named, *pictures) if not (ROOT / path).exists()] == []
    assert named


def test_the_scenarios_shown_are_some(tmp_path):
    shown = []
    for block in (b for b in blocks("toml") if "[path]" in b):
        (tmp_path / "mine.toml").write_text(block)
        shown.append(load_scenario(str(tmp_path / "mine.toml")))
    around, out = shown
    assert around.path.kind == "waypoints"
    assert out.path.kind == "route"
    assert len(out.obstacles) == 3


def test_the_system_shown_is_checked_and_planned(tmp_path, capsys):
    (block,) = (b for b in blocks("toml") if "[strata" in b)
    path = tmp_path / "cupboard.toml"
    path.write_text(block)
    assert main(["check", str(path)]) == 0
    assert "controllable, as the closure shows" in capsys.readouterr().out
    assert main(["plan", str(path), "--replan", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error"] < 1e-9  # what aiming promises


def test_the_card_shown_has_the_keys_of_the_shipped_cards():
    (block,) = (b for b in blocks("toml") if "[gait]" in b)
    shown = tomllib.loads(block)
    real = tomllib.loads((ROOT / "models" / "robots" / "hexapod.toml").read_text())
    assert real.keys() - {"description"} <= shown.keys()
    assert real["leg"]["1"].keys() <= shown["leg"]["1"].keys()


def test_the_comparison_shown_has_todays_rows_and_columns():
    (shown,) = (block for block in blocks("console") if "$ scripts/run\n" in block)
    lines = shown.splitlines()
    rows = lines[lines.index(HEADER) + 1 :][: len(PREDICTIONS) + 2]
    assert [row.split()[0] for row in rows] == [
        "goal",
        *PREDICTIONS.values(),
        "achieved",
    ]
