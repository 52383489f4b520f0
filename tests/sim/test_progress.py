"""Bars are for terminals that may draw them; others get a plain line now and then."""

import os
import pty
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from planner.support.stopping import tick
from sim import progress
from sim.progress import Lines, Pace, at_most, bar, silent, stage
from tests.commands import PROGRESS

PATIENCE = 15.0  # [s] between lines where there is no bar

PROGRAM = (
    "import time\n"
    "from sim.progress import bar\n"
    "with bar() as show:\n"
    "    show('comparing', 0.0)\n"
    "    show('walking', 0.0)\n"
    "    time.sleep(0.5)\n"
    "    show('walking, 1 of 2', 0.5)\n"
    "    time.sleep(0.3)\n"
    "    show('walking', 1.0)\n"
)


def drawn(**environment):
    """What a bar writes to a real terminal."""
    master, slave = pty.openpty()
    surroundings = {k: v for k, v in os.environ.items() if k != "NO_COLOR"}
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM],
        stderr=slave,
        env=surroundings | {"PYTHONPATH": os.getcwd()} | environment,
    )
    process.wait(timeout=60)
    os.close(slave)
    said = b""
    try:
        while piece := os.read(master, 4096):
            said += piece
    except OSError:  # the other end is closed and everything is read
        pass
    os.close(master)
    assert process.returncode == 0
    return said


@pytest.mark.parametrize("error", [BrokenPipeError, OSError])
def test_a_line_that_cannot_be_said_ends_no_work(error, monkeypatch):
    """It ended sweeps of which someone saw the first lines alone, with 0."""

    def write(text):
        raise error

    now, silenced = iter([0.0, 0.0, 0.0, 16.0, 16.0]), []
    monkeypatch.setattr("sys.stderr", SimpleNamespace(write=write, flush=print))
    monkeypatch.setattr("os.dup2", lambda _, number: silenced.append(number))
    lines = Lines(lambda: next(now))
    lines("walking", 0.1)
    lines("walking", 0.2)
    assert silenced == [2]


def test_a_terminal_shows_a_bar_the_share_that_is_done_and_the_time_left():
    said = drawn(TERM="xterm")
    for words in (
        b"comparing",
        b"walking, 1 of 2",
        b" 50%",
        b"about 1 s left",
        b"0:00:0",
    ):
        assert words in said


@pytest.mark.parametrize("plain", [{"NO_COLOR": "1"}, {"TERM": "dumb"}], ids=str)
def test_a_terminal_that_wants_plain_text_shows_none(plain):
    assert drawn(**{"TERM": "xterm", **plain}) == b""


def test_a_pipe_is_told_now_and_then_how_far_it_is_and_how_long_it_will_take(capsys):
    seconds = [0.0]  # a clock that is set by hand
    tell = Lines(lambda: seconds[0])
    tell("planning", 0.0)
    for second in range(1, 41):
        seconds[0] = float(second)
        tell("walking", second / 100)
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["walking  15%, about 85 s left", "walking  30%, about 70 s left"]
    assert all(PROGRESS.fullmatch(line) for line in lines)


def test_a_stage_that_ends_soon_is_not_worth_a_line(capsys):
    seconds = [0.0]
    tell = Lines(lambda: seconds[0])
    tell("report", 0.0)
    seconds[0] = PATIENCE + 1
    tell("report", 1.0)
    tell("filming", 0.01)
    assert capsys.readouterr().err == "filming   1%, 0 s so far\n"


def test_a_stage_that_says_nothing_of_itself_is_told_as_well(capsys):
    seconds = [0.0]
    tell = Lines(lambda: seconds[0])
    tell("comparing", 0.0)
    for second in range(1, 41):
        seconds[0] = float(second)
        tell.remind()
    tell("comparing", 1.0)
    seconds[0] = 100.0
    tell.remind()
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["comparing, 15 s so far", "comparing, 30 s so far"]
    assert all(PROGRESS.fullmatch(line) for line in lines)


def test_a_stage_that_begins_anew_is_told_as_the_first_time(capsys):
    seconds = [0.0]
    tell = Lines(lambda: seconds[0])
    for began in (0.0, 20.0):
        for second in range(20):
            seconds[0] = began + second
            tell("planning", second / 100)
        tell("planning", 1.0)
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["planning  15%, about 85 s left", "planning  10%, about 90 s left"]


def test_reminders_come_of_themselves_and_end(capsys, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.5)
    before, said = threading.active_count(), ""
    with bar() as show:
        show("comparing", 0.0)
        began = time.monotonic()
        while not said and time.monotonic() < began + 20:
            time.sleep(0.01)
            said = capsys.readouterr().err
    assert said == "comparing, 1 s so far\n"
    while threading.active_count() > before:
        assert time.monotonic() < began + 30
        time.sleep(0.01)


def test_a_search_says_how_long_it_may_take(capsys):
    told = []
    with at_most(lambda *words: told.append(words), "planning", 300.0):
        tick()
    (first, begun), (second, reported), (last, ended) = told
    assert first == second == last == "planning, 300 s at most"
    assert begun == 0.0 < reported < 0.01 < ended == 1.0


def left(reports, now):
    pace = Pace(0.0)
    for fraction, at in reports:
        pace.report(fraction, at)
    return pace.left(now)


def test_the_time_left_is_not_guessed_too_early():
    assert left([(0.04, 10.0)], 10.0) == left([(1.0, 10.0)], 10.0) == ""
    assert left([(0.25, 10.0)], 10.0) == "about 30 s left"


def test_an_estimate_falls_while_a_long_part_is_under_way():
    assert left([(0.25, 10.0)], 25.0) == "about 15 s left"
    assert left([(0.25, 10.0)], 99.0) == "about 1 s left"


def test_a_slow_beginning_does_not_count_after_a_fifth():
    """Processes take 20 s to start; then 100 parts take a second each."""
    reports = [(k / 100, 20.0 + k) for k in range(1, 21)]
    said = int(left(reports, 40.0).split()[1])
    assert 80 / 1.5 < said < 80 * 1.5


def test_a_pipe_gets_lines_without_colours_and_json_gets_nothing(capsys):
    with bar() as show:
        assert isinstance(show, Lines)
    with bar(quiet=True) as show:
        assert show is silent


def test_a_stage_has_a_beginning_and_an_end():
    told = []
    with stage(lambda *words: told.append(words), "writing"):
        assert told == [("writing", 0.0)]
    assert told == [("writing", 0.0), ("writing", 1.0)]
