"""Exit codes are those of the page of commands, and of the signals that end it."""

import errno
import os
import re
import signal
from pathlib import Path

import pytest

from sim.endings import ENDS, ExitCode, begin
from sim.errors import FilesError, last_words
from sim.folder import whole
from sim.progress import bar

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text()
ROWS = dict(re.findall(r"^\| (\d+) \| (.*) \|$", PAGE, re.MULTILINE))


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (ExitCode.OK, "all is well"),
        (ExitCode.USAGE, "bad usage"),
        (ExitCode.MODEL, "robot"),
        (ExitCode.SIMULATION, "simulation"),
        (ExitCode.RENDER, "drawn"),
        (ExitCode.FILES, "disk"),
        (ExitCode.TOLERANCE, "tolerance"),
        (ExitCode.SWEEP, "sweep"),
        (ExitCode.BUG, "a bug of ours"),
    ],
)
def test_an_exit_code_is_the_one_of_the_page_of_commands(code, said):
    assert said in ROWS[str(int(code))]


@pytest.mark.parametrize("number", ENDS)
def test_a_signal_ends_the_command_as_shells_tell_it(number):
    """128 and the number of the signal, as if nobody had answered it."""
    assert ENDS[number][0] == 128 + signal.Signals(number)


@pytest.mark.parametrize(
    ("number", "further"),
    [
        (errno.ENOSPC, "; written files are complete; start again: stratawalk film r"),
        (errno.EACCES, "choose a folder that can be written"),
    ],
)
def test_a_full_disk_is_told_with_the_command_that_goes_on(tmp_path, number, further):
    begin(["film", "r"])
    with pytest.raises(FilesError) as full, whole(tmp_path / "video.mp4"):
        raise OSError(number, os.strerror(number))
    assert last_words(full.value).endswith(further)


def test_progress_is_shown_unless_it_is_to_be_quiet():
    assert type(bar()) is type(bar(quiet=False))
    assert type(bar()) is not type(bar(quiet=True))
