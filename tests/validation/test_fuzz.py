"""What nobody would write ends the command as everything else does."""

import os
import re
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from models.description import inspection
from scripts import fuzz
from scripts.endings import Bounds, Ending, ending, other
from scripts.fuzz import KINDS, answer, decided, fault, main
from tests.commands import FORKS

pytestmark = pytest.mark.usefixtures("alone")  # limits of time and memory are at work
ROOT = Path(__file__).resolve().parents[2]
BRIEF, LONG = 2, 30  # [s], for all kinds of input together and for each by itself


@pytest.mark.parametrize(
    ("kinds", "seconds"),
    [
        pytest.param(KINDS, BRIEF, id="all"),
        *(pytest.param([k], LONG, id=k, marks=pytest.mark.full) for k in KINDS),
    ],
)
def test_no_mutated_input_breaks_the_command(kinds, seconds, tmp_path):
    """Cases are forked, for which the process that searches must have no threads."""
    words = ["--seconds", f"{seconds}", "--keep", f"{tmp_path}", "--patience", "240"]
    printed = tmp_path / "printed"
    searching = FORKS.Process(
        target=search, args=([*words, "--kinds", *kinds], printed)
    )
    searching.start()
    searching.join()
    said = printed.read_text()
    assert searching.exitcode == 0, said
    assert re.search(r"^[1-9]\d* cases, 0 faults", said, re.MULTILINE)


def search(words, printed):
    """Be the script, in a process that has loaded all libraries."""
    inspection.subprocess = subprocess
    sys.argv = ["fuzz", *words]
    with printed.open("w") as sys.stdout:
        sys.exit(main())


def test_the_search_counts_and_keeps_what_fails(tmp_path, monkeypatch, capsys):
    words = ["fuzz", "--cases", "2", "--keep", str(tmp_path), "--kinds", "scenario"]
    monkeypatch.setattr(sys, "argv", words)
    monkeypatch.setattr(fuzz, "fault", lambda *given: "it fails")
    assert main() == 1
    assert "2 cases, 2 faults" in capsys.readouterr().out
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.setattr(fuzz, "fault", lambda *given: None)
    assert main() == 0
    assert "2 cases, 0 faults" in capsys.readouterr().out


def test_the_fuzz_sees_what_is_wrong():
    """A bug, a second line and a silent failure are all faults."""
    for code, lines in ((70, ["a"]), (2, ["a", "b"]), (2, []), (0, ["a"]), (None, [])):
        assert Ending(code, "", lines).wrong is not None
    assert Ending(0, "", []).wrong is None
    assert Ending(2, "", ["one"]).wrong is None
    assert Ending(0, "", ["stratawalk: notice: so"]).wrong is None


def test_a_process_that_a_thread_begins_ends_with_its_code(tmp_path):
    """As a program that it runs does, whose signals it hands on."""
    with ThreadPoolExecutor(1) as pool:
        for shell, code in (("exit 3", 3), ("kill -TERM $$", -signal.SIGTERM)):
            words = ["sh", "-c", f"echo said >&2; {shell}"]
            act = partial(other, words, os.environ)
            assert pool.submit(ending, act, tmp_path, 60).result() == Ending(
                code, "", ["said"]
            )


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
    words = ["robots", "mine.xml"]
    assert "in time" in fault(words, tmp_path, Bounds(patience=0.5))
    (tmp_path / "mine.xml").write_text("")
    assert decided(words, tmp_path, Bounds(patience=100)) is None  # on a busy machine


def test_what_the_real_command_bears_is_no_find(tmp_path):
    """A model that brings the compiler down ends only the process that tries it."""
    more = '<asset><model name="a" file="mine.xml"/></asset><worldbody>'
    robot(tmp_path, "<worldbody>", f'{more}<attach model="a" prefix="q"/>')
    words = ["robots", "mine.xml"]
    room = Bounds(seconds=60.0, memory=6 * 10**9)  # until the compiler has no stack
    assert f"ends with -{signal.SIGSEGV}" in answer(words, tmp_path, room)
    assert decided(words, tmp_path) is None


FINDS = {
    "a foot beyond all numbers": ('-0.052" rgba', f'{2**63}" rgba'),
    "a start beyond all numbers": ("0 0 0.06 1", f"0 0 {2**63} 1"),
}


@pytest.mark.parametrize(("old", "new"), FINDS.values(), ids=FINDS)
def test_what_the_fuzz_found_stays_found(old, new, tmp_path):
    robot(tmp_path, old, new)
    assert decided(["robots", "mine.xml"], tmp_path) is None
