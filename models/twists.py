"""Body twists: how a robot moves when its loaded legs swing.

Every prediction is one `TwistModel`. The ideal one below is the paper's constant stride
and yaw gain; others may depend on the angles of the legs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.robot import Robot

Array = np.ndarray


class TwistModel(Protocol):
    """The body twist on a stratum, for many configurations at once."""

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """Twist (forward, left, yaw) of the body in its own frame, shape (N, 3).

        Args:
            stratum: Groups in contact.
            swing: Angle of each group, shape (N, G) [rad].
            rates: Rate of each group, shape (N, G) [rad/s]; [rad] for a displacement.
        """
        ...


@dataclass(frozen=True)
class IdealTwists:
    """Constant stride and yaw gain of each group in contact, eqs. (16)-(18)."""

    robot: Robot
    per_radian: Mapping[str, Sequence[float]]  # group -> forward, left [m], yaw [rad]

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """Sum over the groups in contact; the angles do not matter."""
        gains = [
            np.multiply(self.per_radian[group], group in stratum)
            for group in self.robot.groups
        ]
        return np.asarray(rates @ np.array(gains))
