"""The real command in a process of its own, as tests run it."""

import os
import sys

from sim.pictures import gl

COMMAND = [sys.executable, "-m", "sim.cli"]
OUTSIDE = {key: value for key, value in os.environ.items() if key != gl.WISH} | {
    "PYTHONPATH": os.getcwd()
}
"""The tests' own surroundings, but for a driver that they may have silenced."""


def refusal(done):
    """The one line that a refused command prints, without its head."""
    assert not done.stdout
    (line,) = done.stderr.splitlines()
    head, _, rest = line.partition("stratawalk: error: ")
    assert head == ""
    return rest
