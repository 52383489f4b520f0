"""`stratawalk design`: designs are checked, and those that go everywhere walked."""

import json
from itertools import islice

import pandas
import pytest

from models.errors import ModelError
from sim.cli import main
from sim.commands import studies
from sim.studies import designing
from sim.studies.designing import DIRECTIONS, designs, directions
from tests.commands import full_disk


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


def test_too_many_designs_to_look_at_are_counted_and_refused(capsys, monkeypatch):
    monkeypatch.setattr(studies, "MOST_DESIGNS", 1689)
    assert main(["design", "hexapod"]) == 2
    said = capsys.readouterr().err
    assert "6 legs have 1,690 designs, which are too many to look at: hexapod; " in said
    assert "--designs 10000" in said
    few = ["design", "hexapod", "--designs", "3", "--walks", "0", "--json"]
    assert main(few) == 0
    assert len(json.loads(capsys.readouterr().out)) == 3


@pytest.mark.parametrize(
    ("name", "code", "said"),
    [
        ("mine.parquet", 2, "already exists: mine.parquet; give another name"),
        ("model.xml", 2, "not a table's name: model.xml; give a name in .parquet"),
        ("mine.parquet/x.parquet", 6, "cannot make the table's folder, "),
    ],
)
def test_a_table_that_cannot_be_kept_is_refused_before_the_work(
    tmp_path, monkeypatch, capsys, name, code, said
):
    monkeypatch.chdir(tmp_path)
    for file in ("mine.parquet", "model.xml"):
        (tmp_path / file).write_text("mine")
    monkeypatch.setattr(studies, "tried", lambda *asked: pytest.fail("work was begun"))
    assert main(["design", "hexapod", "--out", name]) == code
    assert said in capsys.readouterr().err
    for file in ("mine.parquet", "model.xml"):
        assert (tmp_path / file).read_text() == "mine"


def test_the_folder_of_a_table_is_made_for_it(tmp_path):
    table = tmp_path / "new" / "designs.parquet"
    few = ["design", "hexapod", "--designs", "3", "--walks", "0", "--out", str(table)]
    assert main(few) == 0
    assert len(pandas.read_parquet(table)) == 3


def test_an_interrupted_search_keeps_its_designs(tmp_path, monkeypatch, capsys):
    """Of many legs it takes hours."""
    monkeypatch.chdir(tmp_path)
    before = studies.tried

    def tried(robot, asked, walks):
        yield from before(robot, islice(asked, 2), walks)
        raise KeyboardInterrupt

    monkeypatch.setattr(studies, "tried", tried)
    few = ["design", "hexapod", "--designs", "9", "--walks", "0"]
    assert main([*few, "--out", "found.parquet"]) == 130
    assert len(pandas.read_parquet("found.parquet")) == 2
    assert capsys.readouterr().err.endswith(
        "found.parquet has 2 of 9 designs; start again: stratawalk design hexapod "
        "--designs 9 --walks 0 --out found-2.parquet\n"
    )
    monkeypatch.setattr(studies, "write_table", full_disk)
    for words, code in ((few, 130), ([*few, "--out", "none.parquet"], 6)):
        assert main(words) == code
        assert "nothing is kept; start again: stratawalk" in capsys.readouterr().err


def test_a_design_that_cannot_be_checked_says_why(hexapod, monkeypatch):
    def refused(robot, described):
        raise ModelError("no two groups of its legs can stand")

    monkeypatch.setattr(designing, "mobility_of", refused)
    assert designing._checked(hexapod) == {
        "status": "no two groups of its legs can stand"
    }
