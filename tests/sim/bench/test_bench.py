"""What the bench measures and how it says so; never how fast this machine is."""

import json
from resource import RUSAGE_CHILDREN
from types import SimpleNamespace

from models.library import shipped_robots
from models.systems.catalogue import SYSTEMS
from sim import cli
from sim.bench import speed
from sim.bench.speed import Row, median, paired

ROWS = [Row("a thing takes", 0.25, "s", "< 0.5"), Row("another weighs", 3, "kg")]


def test_every_row_says_what_is_wanted_where_something_is(monkeypatch, capsys):
    monkeypatch.setattr(speed, "measure", lambda: iter(ROWS))
    assert cli.main(["bench"]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert " ".join(first.split()) == "a thing takes 0.25 s wanted < 0.5"
    assert " ".join(second.split()) == "another weighs 3 kg"


def test_rows_are_also_json(monkeypatch, capsys):
    monkeypatch.setattr(speed, "measure", lambda: iter(ROWS))
    assert cli.main(["bench", "--json"]) == 0
    first, _ = json.loads(capsys.readouterr().out)
    assert first == {
        "what": "a thing takes",
        "value": 0.25,
        "unit": "s",
        "wanted": "< 0.5",
    }


def test_everything_that_is_shipped_is_compiled():
    measured = {row.what.split()[1] for row in speed.compilation()}
    assert measured == {*SYSTEMS, *shipped_robots()}


def test_plans_and_rollouts_of_a_system_are_measured_in_one_run():
    each, ratio = speed.segments("unicycle", most=20)
    assert (each.what, each.unit) == ("system unicycle: 20 segments, each in", "us")
    assert ratio.what == "system unicycle: rollout time over plan time"
    assert each.value > 0
    assert ratio.value > 0


def test_a_warm_up_is_not_measured():
    calls = []
    median(lambda: calls.append(1), repeats=3)
    assert len(calls) == 4


def test_pairs_are_interleaved():
    calls = []
    paired(lambda: calls.append("other"), lambda: calls.append("ours"))
    assert calls == ["other", "ours"] * (len(calls) // 2)


def test_memory_of_the_command_is_that_of_its_processes_in_megabytes(monkeypatch):
    started = []
    monkeypatch.setattr(
        speed.subprocess, "run", lambda words, **_: started.append(words)
    )
    usage = SimpleNamespace(ru_maxrss=300 * 1024)  # KiB, as Linux counts
    monkeypatch.setattr(speed.resource, "getrusage", {RUSAGE_CHILDREN: usage}.get)
    *_, memory = speed.command()
    assert (memory.value, memory.unit) == (300.0, "MB")
    assert started[-1][3:5] == ["run", "ellipse"]


def test_optimised_walks_are_measured_beside_the_printed_one(monkeypatch):
    short = {"path.goal": [0.015, 0.0, 0.0], "segments": 1}
    short |= {"path_tolerance": 0.02, "hops": 0}
    monkeypatch.setattr(speed, "WALKS", {"short": (short, 20.0)})
    first, seconds, least, factor, took = speed.optimised()
    assert first.wanted == "< 2"
    assert 1.0 < least.value < seconds.value < 20.0
    assert factor.value >= 1.0
    assert took.value > 0.0
