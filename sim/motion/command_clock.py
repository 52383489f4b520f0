"""When servos get their commands: k at the first physics step at or after k / rate."""

from __future__ import annotations

import numpy as np

from planner import Array

SLACK = 1e-9  # of a number of a command or step, for rounding


def command_at(step: Array, pace: float) -> Array:
    """Numbers of the commands in force during steps, at a pace of commands a step."""
    return np.floor(step * pace + SLACK).astype(int)


def step_of(command: Array, pace: float) -> Array:
    """Physics steps at which commands of these numbers are given."""
    return np.ceil(command / pace - SLACK).astype(int)
