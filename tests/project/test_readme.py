"""README and docs tell the truth: what they name exists, what they show is so."""

import argparse
import json
import re
import tomllib

import pytest

from models.library import shipped_robots
from models.systems.catalogue import SYSTEMS
from sim.cli import main
from sim.commands.declared import COMMANDS
from sim.commands.parsing import parser
from sim.evaluation.quantities import HEADER, LINES, OF_WALKS
from sim.scenarios.file import load_scenario, shipped_scenarios
from sim.scenarios.predictions import LABELS
from tests.pages import PAGES, README, ROOT, blocks, commands, name_of

PROGRAMS = [*(ROOT / "scripts").glob("*.py"), *(ROOT / "examples").glob("*.py")]
LINK = r"\]\(([^):#]+\.md)"
OTHERS = r"^\$ dask .*$"  # commands of others, whose options are theirs
FOREIGN = {
    "--foreground",
    "--preserve-status",
    "--force-reinstall",
    "--no-deps",
    "--size",
}
"""Options of timeout and pip, and one that there is not, in the table of faults."""
OUR_PATH = r"`((?:planner|models|sim|scripts|tests|docs|examples)/[\w./-]*)`"


def blocks_with(language, text):
    return [block.text for block in blocks(language) if text in block.text]


def options_of_commands():
    (commands,) = (
        a for a in parser()._actions if isinstance(a, argparse._SubParsersAction)
    )
    parsers = (parser(), *commands.choices.values())
    return {word for p in parsers for a in p._actions for word in a.option_strings}


def options_of_programs():
    source = "".join(path.read_text() for path in PROGRAMS)
    return set(re.findall(r'add_argument\(\s*"(--[a-z-]+)"', source))


@pytest.mark.parametrize("command", commands(), ids=str)
def test_every_command_line_parses_and_names_what_is_shipped(command):
    given = parser().parse_args(command.words)
    assert getattr(given, "scenario", None) in (*shipped_scenarios(), *SYSTEMS, None)
    assert getattr(given, "system", None) in (*shipped_robots(), *SYSTEMS, None)
    assert getattr(given, "robot", None) in (*shipped_robots(), None)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_option_exists(page):
    text = re.sub(OTHERS, "", page.read_text(), flags=re.M)
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))
    known = options_of_commands() | options_of_programs() | FOREIGN
    assert named - known == set()


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_command_named_exists(page):
    named = set(re.findall(r"[`$] ?stratawalk ([a-z]+)", page.read_text()))
    assert named <= set(COMMANDS)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_path_of_this_project_exists(page):
    text = page.read_text()
    named = [ROOT / path for path in re.findall(OUR_PATH, text)]
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", text)
    linked = [page.parent / link for link in links if "://" not in link]
    assert [str(path) for path in (*named, *linked) if not path.exists()] == []


def test_the_readme_or_the_contents_of_the_site_lead_to_every_page():
    contents = ROOT / "docs" / "index.md"
    text = contents.read_text()
    trees = re.findall(r"```{toctree}(.*?)```", text, re.DOTALL)
    listed = [contents.parent / f"{line}.md" for t in trees for line in t.split("\n")]
    links = [README.parent / link for link in re.findall(LINK, README.read_text())]
    assert [
        name_of(p) for p in PAGES if p not in (README, contents, *links, *listed)
    ] == []


def test_the_scenarios_shown_are_some(tmp_path):
    shown = []
    for block in blocks_with("toml", "[path]"):
        (tmp_path / "mine.toml").write_text(block)
        shown.append(load_scenario(str(tmp_path / "mine.toml")))
    around, snake, out = shown
    assert snake.path.goal[0] == pytest.approx(0.15)
    assert around.path.kind == "waypoints"
    assert out.path.kind == "route"
    assert len(out.obstacles) == 3


def test_the_system_shown_is_checked_and_planned(tmp_path, capsys):
    block, trailer = blocks_with("toml", "[strata")
    (tmp_path / "trailer.toml").write_text(trailer)
    assert main(["plan", str(tmp_path / "trailer.toml")]) == 0
    assert "exact" in capsys.readouterr().out
    path = tmp_path / "cupboard.toml"
    path.write_text(block)
    assert main(["check", str(path)]) == 0
    assert "controllable, as the closure shows" in capsys.readouterr().out
    assert main(["plan", str(path), "--replan", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error"] < 1e-9  # what aiming promises


def test_the_card_shown_has_the_keys_of_the_shipped_cards():
    (block,) = blocks_with("toml", "[gait]")
    shown = tomllib.loads(block)
    real = tomllib.loads((ROOT / "models" / "robots" / "hexapod.toml").read_text())
    assert real.keys() - {"description"} <= shown.keys()
    assert real["leg"]["1"].keys() <= shown["leg"]["1"].keys()


TERMS = ("terms", "margin:", "slip:", "while")  # first words of what explains the rows


def test_the_comparisons_shown_have_todays_rows_and_columns():
    """All rows on the first page, and elsewhere those of the predictions made."""
    known, shown = ["goal", *LABELS, "achieved", "exported"], list[list[str]]()
    below = {*TERMS, *(one.label.split()[0] for one in (*LINES, *OF_WALKS))}
    for text in blocks_with("text", HEADER):
        table = text.partition(f"{HEADER}\n")[2].partition("\n\n")[0]
        rows = [line.split()[0] for line in table.splitlines()]
        shown.append([name for name in rows if name not in below])
    assert shown[0] == known[:-1]
    assert all(rows == [name for name in known if name in rows] for rows in shown)
