"""What walks say when they are interrupted, and what becomes of several draws."""

import json
from argparse import Namespace
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import pytest

from sim import endings, run_folder
from sim.cli import main
from sim.commands import walks
from sim.commands.walks import Try, judged_tries, tries_of, walk_tries
from sim.errors import ExitCode, FilesError, SimulationError, UsageError
from sim.folder import RunFolder
from sim.scenarios.file import load_scenario

LINE = load_scenario("line", {"draw": 5, "zero_offset": 0.01})


@pytest.fixture
def interrupted(monkeypatch, tmp_path):
    """Make the end of a walk that is interrupted as soon as it has a folder."""
    out = tmp_path / "walk"
    out.mkdir()
    monkeypatch.setattr(walks, "claim", lambda *_: RunFolder(out))
    monkeypatch.setattr(endings, "_words", ("run", "line", "--tries", "4"))
    said = []

    @contextmanager
    def keeping(kept):
        said.append(kept())
        raise KeyboardInterrupt
        yield

    monkeypatch.setattr(walks, "keeping", keeping)

    def of(walk, *given):
        options = Namespace(out=None, json=True, tries=4, tolerance=0.05)
        with pytest.raises(KeyboardInterrupt):
            walk(*(options if word is ... else word for word in given))
        return said.pop()

    return out, of


def test_draws_that_are_kept_are_not_walked_again(interrupted):
    out, of = interrupted
    table, rest = out / "tries.csv", "go on: stratawalk run line"
    given = tries_of, LINE, None, ..., []
    again = "no draw is done; start again: stratawalk run line --tries 4"
    assert of(*given) == again
    table.write_text("draw,verdict\n5,arrived\n6,arrived\n7,fell\n8,fell\n")
    assert of(*given).startswith("4 of 4 draws are kept")  # between two words
    table.write_text("draw,verdict\n5,arrived\n6,arrived\n7,fell\n")
    assert of(*given) == (
        f"3 of 4 draws are kept in {table}; {rest} --draw 8 --tries 1"
    )


def test_a_full_disk_ends_all_draws(monkeypatch, tmp_path):
    walked = []

    def run(scenario, *_, **__):
        walked.append(scenario.draw)
        raise error

    monkeypatch.setattr(run_folder, "run", run)
    error = FilesError("the disk is full", "here", "make room")
    given = LINE, None, RunFolder(tmp_path), range(3), lambda *_: None
    with pytest.raises(FilesError):
        walk_tries(*given)
    assert walked == [0]
    error = SimulationError("it fell", "t = 1 s", "walk slower")
    (tmp_path / "draw-000").rmdir()
    assert [one.draw for one in walk_tries(*given)] == [0, 1, 2]


def test_what_the_first_draw_may_not_have_is_refused_for_all(monkeypatch, tmp_path):
    """A later draw may be refused what it was dealt, and the others go on."""

    def run(scenario, folder, **__):
        if scenario.draw == refused:
            folder.path.rmdir()
            raise UsageError("swing_speed = 9 is not allowed", "draw", "turn slower")
        return SimpleNamespace(verdict="arrived", weighed=None)

    monkeypatch.setattr(walks, "MEASURES", {})
    monkeypatch.setattr(run_folder, "run", run)
    options = Namespace(
        out=str(tmp_path / "a" / "b"), json=True, tries=3, tolerance=0.05
    )
    refused = 5
    with pytest.raises(UsageError, match="turn slower"):
        tries_of(LINE, None, options, [])
    assert list(tmp_path.iterdir()) == []
    refused = 6
    assert tries_of(LINE, None, options, []) is ExitCode.SIMULATION
    table = (tmp_path / "a" / "b" / "tries.csv").read_text().splitlines()
    assert [row.partition(",")[0] for row in table] == ["draw", "5", "6", "7"]


def test_draws_beyond_the_last_are_refused_before_a_folder_is_made(monkeypatch):
    monkeypatch.setattr(walks, "claim", pytest.fail)
    options = Namespace(out=None, json=True, tries=2, tolerance=0.05)
    with pytest.raises(UsageError, match="draw = 4294967296 is not allowed"):
        tries_of(replace(LINE, draw=2**32 - 1), None, options, [])


def test_a_walk_that_is_complete_goes_on_with_its_pictures(interrupted):
    out, of = interrupted
    (out / "summary.json").write_text("{}")
    show, film = f"stratawalk show {out}", f"stratawalk film {out} --look final"
    for look, on in ((None, show), ("final", f"{show} && {film}")):
        said = of(walks._walk, LINE, None, look, ..., [])
        assert said == f"the walk is complete; go on: {on}"
    (out / "report.html").touch()
    for look, on in ((None, show), ("final", film)):
        said = of(walks._walk, LINE, None, look, ..., [])
        assert said == f"the walk is complete; go on: {on}"


def test_a_draw_is_as_far_off_as_its_end_or_its_prediction(monkeypatch, tmp_path):
    """Whichever is more; without a goal it is the prediction alone."""
    weighed = [
        SimpleNamespace(goal=0.03, farthest=0.02),
        SimpleNamespace(goal=0.01, farthest=0.02),
        SimpleNamespace(goal=None, farthest=0.02),
        None,
    ]
    monkeypatch.setattr(walks, "MEASURES", {})
    monkeypatch.setattr(
        run_folder,
        "run",
        lambda scenario, *_, **__: SimpleNamespace(
            verdict="arrived", weighed=weighed[scenario.draw]
        ),
    )
    plain = replace(LINE, draw=0)
    said = []
    folder = RunFolder(tmp_path)
    tries = walk_tries(plain, None, folder, range(4), lambda *now: said.append(now))
    assert [one.off for one in tries] == [0.03, 0.02, 0.02, None]
    assert [share for _, share in said] == [0, 0.25, 0.5, 0.75]
    assert len((tmp_path / "tries.csv").read_text().splitlines()) == 1 + 4


def test_draws_are_judged_by_the_worst_and_none_that_ends_on_the_spot_is_off(capsys):
    def judged(*offs):
        tries = [Try(3 + i, "arrived", off=off) for i, off in enumerate(offs)]
        return judged_tries(tries, 0.05, "see there")

    assert judged(0.0, 0.0) == judged(0.0, 0.04) == judged(0.05) == ExitCode.OK
    assert capsys.readouterr().err == ""
    assert judged(0.0, 0.05, 0.061, 0.09) == ExitCode.TOLERANCE
    assert capsys.readouterr().err == (
        "stratawalk: error: 2 ended farther off goal or prediction than --tolerance "
        "0.05, at worst 9 % of the path, yaw included: 4 draws; see there\n"
    )
    assert judged(0.0, None) == ExitCode.SIMULATION
    assert "1 failed, draw 4 first (arrived)" in capsys.readouterr().err


@pytest.mark.parametrize("given", [None, ("ideal", "compliant")])
def test_draws_make_the_predictions_that_are_asked_for(
    given, monkeypatch, tmp_path, capsys
):
    """Those that cost as much as walks are left out where none are named."""
    made = []

    def run(scenario, folder, **_):
        made.append(scenario.predictions)
        return SimpleNamespace(verdict="arrived", weighed=None)

    monkeypatch.setattr(walks, "MEASURES", {})
    monkeypatch.setattr(run_folder, "run", run)
    asked = [] if given is None else ["--set", f"predictions={json.dumps(given)}"]
    words = ["run", "line", "--tries", "1", *asked, "--out", str(tmp_path / "a")]
    assert main([*words, "--no-video"]) == ExitCode.SIMULATION
    assert made == [given or ("ideal", "quasi_static")]
    ignored = "(ideal, compliant)" if given else "(ideal, quasi-static)"
    assert f"{ignored}\n" in capsys.readouterr().err  # and of no others


@pytest.mark.parametrize(
    ("drawn", "fixed"),
    [
        ({"bumps": 0.01}, {}),
        ({"zero_offset": 0.01}, {"zero_offset": (0.01,) * 12}),
        ({"dead_band_spread": 0.01}, {}),
        ({"replan": True, "sense": "tag"}, {"replan": True}),
    ],
    ids=str,
)
def test_draws_of_what_is_not_random_are_refused(drawn, fixed, monkeypatch):
    """They would all be the same walk."""
    monkeypatch.setattr(walks, "claim", lambda *_: done.append(1) or 1 / 0)
    options, done = Namespace(out=None, json=True, tries=2, tolerance=0.05), []
    same = replace(LINE, zero_offset=0.0, payload=(0.3, 0.0, 0.0, 0.02))
    with pytest.raises(UsageError, match="nothing of this walk is drawn.*: --tries;"):
        tries_of(replace(same, **fixed), None, options, [])
    with pytest.raises(ZeroDivisionError):
        tries_of(replace(same, **drawn), None, options, [])
    assert done == [1]


@pytest.mark.parametrize(
    ("given", "kept"), [({}, "hobby"), ({"zero_offset": 0.03}, None)]
)
def test_draws_are_of_the_imperfections_that_are_given(given, kept, monkeypatch):
    asked = []
    monkeypatch.setattr(walks, "tries_of", lambda scenario, *_: asked.append(scenario))
    plain = replace(LINE, zero_offset=0.0)
    monkeypatch.setattr(walks.cli, "scenario_of", lambda _: replace(plain, **given))
    walks.run(Namespace(video=False, tries=2, allow_external=False))
    assert asked[0].imperfect == kept
