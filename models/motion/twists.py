"""Body twists: the motion of a robot's body when its loaded legs swing.

Every prediction is a `TwistModel`: the ideal one has the paper's constant stride and
yaw gain, the quasi-static one follows from the contact kinematics of the actual legs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from models.contact.dissipation import least_dissipation_twist
from models.contact.ground import Ground
from models.contact.kinematics import Kinematics, Stance
from models.contact.loads import static_loads
from models.contact.sliding import sliding_twist
from models.motion.robot_equations import Equations
from planner import Array


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
    """Constant stride and yaw gain of each field, eqs. (16)-(18)."""

    equations: Equations

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """The fields of the stratum that together have these rates, added up."""
        equations = self.equations
        on = [f for f, s in equations.system.stratum_of.items() if s == stratum]
        swings = [name for name in on if name in equations.swings]
        directions = np.array([equations.swings[name] for name in swings])
        twists = np.array([equations.twists[name] for name in swings])
        return rates @ np.linalg.pinv(directions) @ twists


@dataclass(frozen=True)
class QuasiStaticTwists:
    """Contact kinematics: the feet slide as little as dry friction under load allows.

    Three feet are loaded by statics alone. On more the loads are those of springs, and
    the engine's soft contacts let them depend on how fast the feet slide.
    """

    kinematics: Kinematics
    ground: Ground
    swing_speed: float = 0.0  # [rad/s], of the fastest group; 0 for Coulomb's law

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """Least dissipation under the loads at the actual angles of the legs."""
        robot = self.kinematics.robot
        on = robot.planted(stratum)
        whole = self.kinematics.stance(swing)
        moved = whole.rates * rates[..., robot.group_of_leg, None]
        stance = Stance(
            feet=whole.feet[:, on],
            rates=whole.rates[:, on],
            gives=whole.gives[:, on],
            height=whole.height[:, on],
            center_of_mass=whole.center_of_mass,
        )
        if on.sum() > 3:
            return self._on_springs(stance, moved[:, on], rates, on)
        loads = static_loads(stance.feet, stance.center_of_mass)
        return least_dissipation_twist(stance.feet, moved[:, on], loads)

    def _on_springs(
        self, stance: Stance, moved: Array, rates: Array, on: Array
    ) -> Array:
        ground = replace(
            self.ground, contact=self.ground.contact[on], servo=self.ground.servo[on]
        )
        fastest = np.abs(rates).max(axis=-1, keepdims=True)
        unit = np.where(fastest > 0, fastest, 1.0)
        per_radian = moved / unit[..., None]
        twist, _ = sliding_twist(stance, per_radian, ground, self.swing_speed)
        return twist * unit
