"""Commands of servos at their own rate, taken from a walk and played in the physics."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from planner import Array
from sim.drive.feed_forward import FeedForward
from sim.errors import UsageError
from sim.motion.schedule import SLACK, command_at, step_of
from sim.physics.engine import STRETCH


@dataclass(frozen=True, eq=False)
class ServoCommands:
    """Angles commanded to servos; ValueError where numbers contradict one another."""

    joints: tuple[str, ...]
    rate: float  # commands a second
    angles: Array  # one row a command, (K, J) [rad]

    def __post_init__(self) -> None:
        if not (np.isfinite(self.rate) and self.rate > 0):
            raise ValueError(f"rate must be positive, got {self.rate}")
        if self.angles.ndim != 2 or self.angles.shape[1] != len(self.joints):
            shape, count = self.angles.shape, len(self.joints)
            raise ValueError(f"angles of shape {shape} for {count} joints")
        if not len(self.angles):
            raise ValueError("no command")
        if not np.isfinite(self.angles).all():
            raise ValueError("an angle is not a finite number")

    @property
    def time(self) -> Array:
        """When each command is given, shape (K,) [s]."""
        return np.arange(len(self.angles)) / self.rate

    def rows(
        self, steps: int, timestep: float, interpolated: bool = False
    ) -> Iterator[Array]:
        """Angles in force, one row a physics step, shape (n, J) each.

        Commands hold until the next one, and the last to the end; interpolated, angles
        move evenly from each to the next.
        """
        pace, last = self.rate * timestep, len(self.angles) - 1
        ahead = FeedForward(self.angles, 1)
        for begin in range(0, steps, STRETCH):
            row = np.arange(begin, min(begin + STRETCH, steps))
            held = np.minimum(command_at(row, pace), last)
            yield ahead.at(row * pace) if interpolated else self.angles[held]


def taken(
    ctrl: Array, joints: tuple[str, ...], actuators: Array, rate: float, timestep: float
) -> ServoCommands:
    """Commands at a rate, at most that of the physics, of one row of ctrl a step."""
    pace = rate * timestep
    if pace > 1 + SLACK:
        raise UsageError.of("too_fast", "--rate", rate=rate, most=1 / timestep)
    step = step_of(np.arange(np.ceil(-SLACK), len(ctrl) * pace + 1), pace)
    row = step[(step >= 0) & (step < len(ctrl))]
    return ServoCommands(joints, rate, ctrl[row][:, actuators])
