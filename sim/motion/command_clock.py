"""When servos get their commands: k at the first physics step at or after k / rate."""

from __future__ import annotations

import numpy as np

from planner import Array

SLACK = 1e-9  # of a number of a command or step, for rounding


def command_at(step: Array, pace: float) -> Array:
    """Number of the command that is in force during physics steps.

    Args:
        step: Numbers of the steps, shape (n,).
        pace: Commands a step.

    Returns:
        Shape (n,), whole numbers.
    """
    return np.floor(step * pace + SLACK).astype(int)


def step_of(command: Array, pace: float) -> Array:
    """Physics step at which commands are given.

    Args:
        command: Numbers of the commands, shape (n,).
        pace: Commands a step.

    Returns:
        Shape (n,), whole numbers.
    """
    return np.ceil(command / pace - SLACK).astype(int)
