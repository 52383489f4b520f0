"""Runs side by side: differences in settings first, one column a run, one page."""

import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sim.cli import main
from sim.reports import comparison, maps
from sim.reports.comparison import compare
from sim.reports.drawing import FEW, stretches
from sim.runs.run import Run, read_run
from tests.browser import ask
from tests.finished_runs import reset, sealed

SEEN = """
return {
  headings: [...document.querySelectorAll("h2")].map((e) => e.textContent),
  columns: document.querySelectorAll("table")[0].rows[0].cells.length,
  first: [...document.querySelector("table").rows].map((e) => e.cells[0].textContent),
  drawings: document.querySelectorAll("figure .drawing svg").length,
  width: document.documentElement.scrollWidth,
};
"""


@pytest.fixture(scope="module")
def runs(walked, tmp_path_factory):
    """The walk, and another that says of itself to have less friction and to fall."""
    parent = tmp_path_factory.mktemp("compared")
    one, other = (shutil.copytree(walked, parent / name) for name in ("one", "other"))
    fell = {"verdict": "fell", "verdict_text": "fell at 3.0 s"}
    reset(other, lambda text: text.replace("friction = 1.0", "friction = 0.3"), **fell)
    return one, other


def test_the_table_begins_with_the_settings_that_differ(runs, capsys):
    assert main(["compare", *map(str, runs)]) == 0
    first, second, empty, *rest = capsys.readouterr().out.splitlines()
    assert first.split() == ["setting", "one", "other"]
    assert second.split() == ["friction", "1.0", "0.3"]
    assert empty == ""
    assert rest[1].split() == ["verdict", "arrived", "fell"]


def test_runs_of_one_scenario_do_not_differ(runs, capsys):
    assert main(["compare", str(runs[0]), str(runs[0])]) == 0
    assert capsys.readouterr().out.startswith("All settings are the same.\n")


def test_runs_of_a_robot_whose_file_was_changed_between_them_differ(
    runs, tmp_path, capsys
):
    copies = [shutil.copytree(runs[0], tmp_path / name) for name in ("a", "b")]
    for copy, mass in zip(copies, ("1", "2"), strict=True):
        summary = json.loads((copy / "summary.json").read_text())
        (copy / "robot").mkdir()
        (copy / "robot" / "mine.xml").write_text(mass)
        sealed(copy, seals=summary["seals"] | {"robot/mine.xml": None})
    assert main(["compare", *map(str, copies)]) == 0
    assert capsys.readouterr().out.splitlines()[1].startswith("robot/mine.xml  sealed")


def test_columns_have_as_much_of_the_path_as_tells_them_apart():
    def named(*places):
        return comparison.names([SimpleNamespace(folder=Path(p)) for p in places])

    assert named("/w/runs/a", "/w/runs/b") == ["a", "b"]
    assert named("/p/runs/a", "/q/runs/a") == ["p/runs/a", "q/runs/a"]
    assert named("/w/runs/a", "/w/runs/a") == ["a", "a"]
    assert named("/a", "/w/a") == ["a", "w/a"]


def test_json_holds_a_row_a_run(runs, capsys):
    assert main(["compare", *map(str, runs), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["run"] for row in found["results"]] == ["one", "other"]
    assert [row["friction"] for row in found["settings"]] == ["1.0", "0.3"]


def test_it_says_what_each_kind_of_phase_adds_to_the_drift(runs, capsys):
    """All phases together come to the way off the ideal prediction."""
    assert main(["compare", *map(str, runs), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    off, left = (
        {n: float(c.replace("−", "-")) for n, c in found[key][0].items() if n != "run"}
        for key in ("drift", "left")
    )
    summary = read_run(runs[0]).summary
    whole, swings = off["all together"], off["all swings"]
    assert whole == pytest.approx(1e3 * summary.error["ideal"].position, abs=0.006)
    rest = off["all lift-offs and touchdowns"] + off["standing still on S12"]
    assert swings + rest == pytest.approx(whole, abs=0.02)
    assert off["swing on S1"] + off["swing on S2"] == pytest.approx(swings, abs=0.02)
    best = 1e3 * summary.error[read_run(runs[0]).best].position
    assert abs(left["all together"]) <= best + 0.005  # that rounding may add
    assert left["all together"] != whole


def test_a_walk_without_numbers_by_phase_says_why(runs, tmp_path, capsys):
    again = shutil.copytree(runs[0], tmp_path / "again")
    replanned = {"error_sources": None, "replan": True}
    reset(again, lambda said: said.replace("plan = false", "plan = true"), **replanned)
    assert main(["compare", str(runs[0]), str(again), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["replan"] for row in found["settings"]] == ["false", "true"]
    for table in (found["drift"], found["left"]):
        assert {*table[1].values()} == {"again", "replanned"}


def test_tables_have_their_numbers_one_below_the_other(runs, capsys):
    assert main(["compare", *map(str, runs)]) == 0
    blocks = capsys.readouterr().out.rstrip().split("\n\n")
    assert len(blocks) == 4
    assert blocks[2].startswith("off the ideal prediction, by phase [mm]")
    for block in blocks:
        assert len({len(line) for line in block.splitlines()}) == 1


def test_a_run_sends_nothing_to_the_terminal_that_it_would_obey(
    walked, tmp_path, capsys
):
    odd = shutil.copytree(walked, tmp_path / "odd")
    own, title = 'robot = "hexapod', r"\u001b]0;title\u0007"
    reset(odd, lambda text: text.replace(own, own + title, 1))
    assert main(["compare", str(walked), str(odd)]) == 0
    said = capsys.readouterr().out
    assert title in said  # as its file has it
    assert all(c.isprintable() or c == "\n" for c in said)
    reset(odd, lambda text: '"\\u009b2J" = 1\n' + text)
    assert main(["compare", str(walked), str(odd)]) == 2
    said = capsys.readouterr().err
    assert r"unknown key '\x9b2J': " in said
    assert all(c.isprintable() or c == "\n" for c in said)


def test_the_page_is_seen_by_a_browser(runs, tmp_path, capsys):
    page = tmp_path / "new folder" / "runs.html"
    assert main(["compare", *map(str, runs), "--out", str(page)]) == 0
    assert page.stat().st_size < 5e6
    seen = ask(page, SEEN, tmp_path, width=375)
    assert seen["headings"][0] == "Settings that differ"
    assert seen["first"] == ["setting", "friction"]
    assert (seen["columns"], seen["drawings"], seen["width"]) == (3, 2, 375)


def test_what_cannot_be_compared_is_refused(runs, tmp_path, capsys):
    mine = tmp_path / "mine.html"
    mine.write_text("notes")
    for words, said in (
        ([runs[0]], "a single run cannot be compared"),
        ([runs[0], tmp_path], "not a finished run"),
        ([*runs, "--out", "page.pdf"], "not a page's name: page.pdf; give a name in"),
        ([*runs, "--out", mine], f"already exists: {mine}; give another name"),
    ):
        assert main(["compare", *map(str, words)]) == 2
        assert said in capsys.readouterr().err
    assert mine.read_text() == "notes"


def test_what_differs_by_little_has_a_digit_more(walked):
    """Errors of several runs are told apart; what they share has its usual digits."""
    run = read_run(walked)
    table = {row[0]: row[1] for row in compare([run, run]).results.rows}
    digits = {label: len(cell.partition(".")[2]) for label, cell in table.items()}
    finer = {"off the goal [mm]": 3, "off the goal in yaw [mrad]": 3}
    for name in ("ideal", "quasi-static"):
        finer |= {f"off {name}, at the end [mm]": 3, f"off {name}, at most [mm]": 3}
    usual = {"least margin [mm]": 1, "slip [mm]": 1, "simulated time [s]": 2}
    wanted = finer | usual | {"bounces": 0, "length of the path [m]": 4}
    assert {label: digits[label] for label in wanted} == wanted
    position = 1e3 * run.summary.error["goal"]["position"]
    assert table["off the goal [mm]"] == f"{position:.3f}"
    share = 0.1 * position / run.summary.path_length
    assert table["off the goal [% of the path]"] == f"{share:.3f}"


def test_curves_of_a_page_are_envelopes_over_parts_of_one_kind(walked, monkeypatch):
    """Beside a walk of few segments, one of many is drawn by its phases, too."""
    run, other = read_run(walked), read_run(walked)
    many = property(lambda self: 1 if self is run else FEW)
    monkeypatch.setattr(Run, "segments", many)
    parts = []

    def kept(one, few=None):
        parts.append((one is run, few))
        return stretches(one, few)

    monkeypatch.setattr(maps, "stretches", kept)
    list(maps.overlaid([("few", run), ("many", other)]))
    assert parts == [(True, True), (False, True)]
    assert len(stretches(run, True)) == len(run.phases) > len(stretches(run, False))


def test_without_an_ideal_prediction_parts_count_along_their_own_way(monkeypatch):
    """As of runs that were played."""
    parts = {"swing S1": np.array([3e-3, 0.0, 0.1]), "swing S2": np.array([0, 4e-3, 0])}
    monkeypatch.setattr(comparison, "contributions", lambda run: {"compliant": parts})
    summary = SimpleNamespace(replan=False)
    run = SimpleNamespace(best="compliant", folder=Path("a"), summary=summary)
    rows = dict(comparison._drift([run]).rows)
    assert rows["swing on S1"] == "1.80"  # 3 mm on a way of 5 mm: 3 * 3 / 5
    assert rows["swing on S2"] == "3.20"
    assert rows["all swings"] == rows["all together"] == "5.00"
    planned = SimpleNamespace(**vars(run) | {"folder": Path("b")})
    of = {"a": {"compliant": parts}, "b": {"ideal": parts}}
    monkeypatch.setattr(comparison, "contributions", lambda run: of[run.folder.name])
    beside = comparison._drift([run, planned], "ideal").rows
    assert {played for _, played, _ in beside} == {comparison.NONE}
