"""What nobody would write ends the command as everything else does."""

import math
import random
import sys
from pathlib import Path

import pytest

from scripts.fuzz import KINDS, OWN, Worker, decided, fault, main, search

ROOT = Path(__file__).resolve().parents[2]
BRIEF = 1  # [s] a kind of input, once a process is there to run its cases
LONG = 30  # as many; eight minutes in all


@pytest.fixture(scope="module")
def worker():
    """The process that runs the cases, whose libraries take longest to load."""
    with Worker(patience=4 * OWN.seconds) as process:
        process.fault(["scenarios"], str(ROOT))
        yield process


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "duration", [BRIEF, pytest.param(LONG, marks=pytest.mark.full)]
)
def test_no_mutated_input_breaks_the_command(worker, kind, duration, tmp_path, capsys):
    found = search(worker, [kind], random.Random(0), duration, math.inf, tmp_path)
    assert found.faults == 0, capsys.readouterr().out
    assert found.done[kind] > 0


def test_the_search_counts_and_keeps_what_fails(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["fuzz", "--cases", "2", "--keep", str(tmp_path)])
    monkeypatch.setattr(Worker, "fault", lambda *given: "it fails")
    assert main() == 1
    assert "2 cases, 2 faults" in capsys.readouterr().out
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.setattr(Worker, "fault", lambda *given: None)
    assert main() == 0
    assert "2 cases, 0 faults" in capsys.readouterr().out


def test_the_fuzz_sees_what_is_wrong(tmp_path, monkeypatch):
    """A bug, a second line and a silent failure are all faults."""
    from sim import cli

    for code, lines in ((70, "one\n"), (2, "one\ntwo\n"), (2, ""), (0, "one\n")):

        def command(words, code=code, lines=lines):
            sys.stderr.write(lines)
            return code

        monkeypatch.setattr(cli, "main", command)
        assert fault(["run"]) is not None
    monkeypatch.setattr(cli, "main", lambda words: 0)
    assert fault(["run"]) is None


BOMB = '<worldbody><replicate count="300000"><geom size="1"/></replicate>'


def robot(folder, old, new):
    """Write the shipped hexapod as `mine`, with something else in its MJCF."""
    for file in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        text = (ROOT / "models" / "robots" / file).read_text()
        text = text.replace(old, new) if file == "hexapod.xml" else text
        (folder / file.replace("hexapod", "mine")).write_text(text)


def test_a_case_that_never_ends_is_a_find_and_not_the_end_of_the_fuzz(tmp_path):
    """The compiler is busy for minutes, and no signal of Python's interrupts it."""
    robot(tmp_path, "<worldbody>", BOMB)
    with Worker(patience=2) as worker:
        said = worker.fault(["robots", "mine.xml"], str(tmp_path))
        assert "or 2 s in all" in said
        (tmp_path / "mine.xml").write_text("")
        worker.patience = 100  # on a busy machine
        assert worker.fault(["robots", "mine.xml"], str(tmp_path)) is None


def test_what_the_real_command_bears_is_no_find(tmp_path):
    """A model that brings the compiler down ends only the process that tries it."""
    more = '<asset><model name="a" file="mine.xml"/></asset><worldbody>'
    robot(tmp_path, "<worldbody>", f'{more}<attach model="a" prefix="q"/>')
    words = ["robots", "mine.xml"]
    with Worker() as worker:
        assert "does not survive" in str(worker.answer(words, str(tmp_path)))
    assert decided(words, str(tmp_path)) is None


FINDS = {
    "a foot beyond all numbers": ('-0.052" rgba', f'{2**63}" rgba'),
    "a start beyond all numbers": ("0 0 0.06 1", f"0 0 {2**63} 1"),
}


@pytest.mark.parametrize(("old", "new"), FINDS.values(), ids=FINDS)
def test_what_the_fuzz_found_stays_found(old, new, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    robot(tmp_path, old, new)
    assert fault(["robots", "mine.xml"]) is None
