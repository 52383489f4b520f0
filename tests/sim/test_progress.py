"""Bars are for terminals that may draw them; pipes and plain terminals have none."""

import os
import pty
import subprocess
import sys

import pytest

PROGRAM = (
    "from sim.progress import bar\n"
    "with bar() as show:\n"
    "    show('walking', 0.5)\n"
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


def test_a_terminal_shows_a_bar():
    assert b"walking" in drawn(TERM="xterm")


@pytest.mark.parametrize("plain", [{"NO_COLOR": "1"}, {"TERM": "dumb"}], ids=str)
def test_a_terminal_that_wants_plain_text_shows_none(plain):
    assert drawn(**{"TERM": "xterm", **plain}) == b""
