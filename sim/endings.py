"""How the command ends: its exit codes, and the signals that end it."""

from __future__ import annotations

import signal
from enum import IntEnum


class ExitCode(IntEnum):
    """How the command ended."""

    OK = 0
    USAGE = 2  # bad usage or configuration
    MODEL = 3  # a robot that cannot be used
    SIMULATION = 4  # planning or simulation failed
    RENDER = 5  # pictures cannot be drawn
    FILES = 6  # disk, permissions
    TOLERANCE = 7  # a comparison came out larger than allowed
    SWEEP = 8  # a sweep ended with failed points
    BUG = 70  # ours
    INTERRUPTED = 130  # SIGINT
    TERMINATED = 143  # SIGTERM


ENDS = {  # what a message says of each signal
    signal.SIGINT: (ExitCode.INTERRUPTED, "interrupted: Ctrl-C"),
    signal.SIGTERM: (ExitCode.TERMINATED, "terminated: SIGTERM"),
}
