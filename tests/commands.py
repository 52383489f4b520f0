"""The real command in a process of its own, as tests run it."""

import os
import sys

from sim.pictures import gl

COMMAND = [sys.executable, "-m", "sim.cli"]
OUTSIDE = {
    key: value
    for key, value in os.environ.items()
    if key != gl.WISH and not key.startswith("PYTHON")
} | {"PYTHONPATH": os.getcwd()}
"""The tests' surroundings without what changes Python or the driver of pictures."""


def refusal(done):
    """The one line that a refused command prints, without its head."""
    assert not done.stdout
    (line,) = done.stderr.splitlines()
    head, _, rest = line.partition("stratawalk: error: ")
    assert head == ""
    return rest
