"""Torques that joints are expected to bear, and the commands that make up for them.

A servo is a spring: loaded by a torque it stands off its command by torque over
stiffness, and moving it lags by its damping. A command that leads the intended angle by
as much leaves the joint where it should be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner import Array

SMOOTHED = 0.05  # [s]; over which torques are averaged, as servos cannot follow faster
SPACING = 0.005  # [s]; between torques that are kept


@dataclass(frozen=True)
class Lead:
    """Smooth torques of all actuators along a stretch of commands.

    Attributes:
        torque: At knots, shape (K, nu) [N m].
        spacing: Steps between knots; the first is at the stretch's first step.
    """

    torque: Array
    spacing: int

    def at(self, rows: Array) -> Array:
        """Torques at steps of the stretch, shape (n, nu)."""
        where = np.minimum(rows / self.spacing, len(self.torque) - 1.0)
        before = np.minimum(where.astype(int), max(len(self.torque) - 2, 0))
        after = np.minimum(before + 1, len(self.torque) - 1)
        part = (where - before)[:, None]
        torque: Array = (1 - part) * self.torque[before] + part * self.torque[after]
        return torque

    @property
    def largest(self) -> tuple[int, int, float]:
        """Step, actuator and size of the largest torque."""
        sizes = np.abs(self.torque)
        knot, actuator = np.unravel_index(sizes.argmax(), sizes.shape)
        return int(knot) * self.spacing, int(actuator), float(sizes.max())


def smoothed(torque: Array, timestep: float) -> Lead:
    """The lead of torques that were recorded at every step.

    Args:
        torque: Shape (n, nu) [N m].
        timestep: [s].
    """
    from scipy.ndimage import uniform_filter1d  # slow to import, and seldom needed

    window = 2 * round(SMOOTHED / timestep / 2) + 1  # odd, so that nothing is shifted
    spacing = max(round(SPACING / timestep), 1)
    smooth = uniform_filter1d(torque, window, axis=0, mode="nearest")
    return Lead(smooth[::spacing].copy(), spacing)
