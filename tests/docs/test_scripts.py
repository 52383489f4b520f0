"""The scripts that keep the pages up to date do what they say."""

import math

import pytest

from scripts import (
    convergence,
    planner_table,
    short_walks,
    show_outputs,
    torture,
    verdicts,
)
from sim import load_scenario

PAGE = """Before.

```console
$ stratawalk --version
an old version
$ stratawalk scenarios      # with no output, so left alone
$ stratawalk systems --json
[]
```

After.
"""


def test_outputs_shown_are_replaced_and_nothing_else(tmp_path, capfd):
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    show_outputs.main([str(page)])
    again = page.read_text()
    kept = [line for line in PAGE.splitlines() if line not in ("an old version", "[]")]
    assert [line for line in again.splitlines() if line in kept] == kept
    assert "\nstratawalk " in again
    assert "an old version" not in again
    assert '"paper-hexapod"' in again
    assert [path.name for path in tmp_path.iterdir()] == ["page.md"]
    ran = capfd.readouterr().out.splitlines()
    assert ran == ["--version", "systems --json"]


def test_a_command_that_fails_leaves_the_page_as_it_was(tmp_path, capfd):
    page = tmp_path / "page.md"
    page.write_text(text := PAGE.replace("systems --json", "systems --jsn"))
    with pytest.raises(SystemExit, match="ended with 2: systems --jsn"):
        show_outputs.main([str(page)])
    assert page.read_text() == text
    assert "--json" in capfd.readouterr().err


def test_short_walks_are_drawn_by_how_they_were_planned(tmp_path):
    ways = ("printed", "shortest", "optimised")
    studies = {"line": [short_walks.Point(way, 80.0, 0.02, 0.1) for way in ways]}
    picture = tmp_path / "walks.svg"
    short_walks.draw(studies, picture)
    assert picture.read_text().count('id="axes_') == len(studies)


def test_a_plan_is_shown_by_its_time_and_its_path_deviation(monkeypatch, capsys):
    short = {"path.goal": [0.02, 0.0, 0.0], "segments": 2}
    monkeypatch.setattr(
        short_walks,
        "load_scenario",
        lambda name, more: load_scenario(name, short | more),
    )
    monkeypatch.setattr(short_walks, "SEGMENTS", {"line": (2,)})
    monkeypatch.setattr(short_walks, "WIDER", ())
    points = short_walks.study("line")
    shown = capsys.readouterr().out.splitlines()
    assert [point.way for point in points] == ["printed", "shortest", "printed"]
    for point, line in zip(points, shown, strict=True):
        assert point.seconds > 1.0
        assert 0.0 < point.position < 0.02
        assert f"{point.way}, " in line
        assert f"{point.seconds:9.1f}{1e3 * point.position:16.1f}" in line


def test_a_row_of_the_planners_table_says_what_the_page_says(monkeypatch):
    """The peers' columns are left out: they take seconds each, and may be missing."""
    cells = [str(cell) for cell in planner_table.row("heisenberg")]
    page = (show_outputs.ROOT / "docs" / "planner-table.md").read_text()
    (shown,) = (line for line in page.splitlines() if line.startswith("| heisenberg |"))
    assert cells[:8] == shown.strip("| ").split(" | ")[:8]


@pytest.mark.full
@pytest.mark.physics
def test_a_point_of_the_convergence_study_is_where_the_page_has_it():
    """At the default speed the turning walk is 0.09 % of its path off."""
    found = convergence.walked("swing_speed", 0.5)
    assert 100 * convergence.share(found) == pytest.approx(0.09, abs=0.005)
    assert found["bounces"] == 0


@pytest.mark.full
@pytest.mark.physics
def test_an_adopted_robot_walks_as_its_row_says(capsys):
    verdicts.main(["--only", "line on daisy", "--segments", "20"])
    *_, row = capsys.readouterr().out.splitlines()
    _, walk, verdict, code, off, *_ = (part.strip() for part in row.split("|"))
    page = (show_outputs.ROOT / "docs" / "adopted-robots.md").read_text()
    (shown,) = (line for line in page.splitlines() if line.startswith("| daisy |"))
    cells = [part.strip() for part in shown.split("|")]
    length = math.sqrt(2) * float(cells[6])
    shares = float(off.removesuffix(" %")), float(cells[8].removesuffix(" mm")) / 10
    assert (walk, verdict, code) == ("line on daisy", cells[7], "0")
    assert shares[0] == pytest.approx(shares[1] / length, abs=0.1)


@pytest.mark.full
@pytest.mark.physics
def test_a_row_of_the_table_of_faults_ends_as_it_says(capsys):
    assert torture.main(["12"]) == 0
    assert "| 12 |" in capsys.readouterr().out


@pytest.mark.physics
def test_a_row_says_how_far_an_imperfection_leads_astray(capsys):
    verdicts.main(["--only", "zeros of lift 1", "--segments", "1"])
    head, _, row = capsys.readouterr().out.splitlines()
    assert head.startswith("| walk | verdict | ends with | off its goal |")
    _, walk, _, code, off, *_ = (part.strip() for part in row.split("|"))
    assert (walk, code) == ("zeros of lift 1", "0")
    assert 1.0 < float(off.removesuffix(" %")) < 10.0  # 3.5 was measured
