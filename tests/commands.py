"""The real command in a process of its own, as tests run it."""

import os
import re
import sys

from sim.pictures import gl

COMMAND = [sys.executable, "-m", "sim.cli"]
OUTSIDE = {
    key: value
    for key, value in os.environ.items()
    if key != gl.ASKED and not key.startswith("PYTHON")
} | {"PYTHONPATH": os.getcwd()}
"""The tests' surroundings without what changes Python or the driver of pictures."""


PROGRESS = re.compile(r"[^:]+, (about \d+ s left|\d+ s so far)")


def told(stderr):
    """Lines on standard error but those that say how far it is, on a slow machine."""
    return [line for line in stderr.splitlines() if not PROGRESS.fullmatch(line)]


def refusal(done):
    """The one line that a refused command prints, without its head."""
    assert not done.stdout
    (line,) = told(done.stderr)
    head, _, rest = line.partition("stratawalk: error: ")
    assert head == ""
    return rest
