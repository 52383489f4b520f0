"""Body twists: the motion of a robot's body when its loaded legs swing.

Every prediction is a `TwistModel`: ideal with constant twists, quasi-static by contact
kinematics, or identified, of polynomials fitted to measurements of each loaded field.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.polynomial import Polynomial

from models.contact.dissipation import ellipses, least_dissipation_twist
from models.contact.kinematics import Kinematics
from models.contact.loads import static_loads
from models.contact.sliding import Ground, sliding_twist
from models.errors import MeasurementError, message
from models.motion.robot_equations import Equations
from planner import Array


class TwistModel(Protocol):
    """The body twist on a stratum, for many configurations at once.

    Example:
        >>> import numpy as np
        >>> from models import IdealTwists, TwistModel, equations, load
        >>> ideal: TwistModel = IdealTwists(equations(load("hexapod")))
        >>> ideal("1", swing=np.zeros((1, 2)), rates=np.array([[0.0, 1.0]]))
        array([[0., 0., 0.]])
    """

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """Twist (forward, left, yaw) of the body in its own frame, shape (N, 3).

        The groups of the stratum are in contact; every group has an angle [rad] and a
        rate [rad/s], or [rad] for a displacement, shape (N, G) each.
        """


@dataclass(frozen=True)
class IdealTwists:
    """Constant stride and yaw gain of each field, eqs. (16)-(18).

    Example:
        >>> import numpy as np
        >>> from models import IdealTwists, equations, load
        >>> ideal = IdealTwists(equations(load("hexapod")))
        >>> ideal("1", swing=np.zeros((1, 2)), rates=np.array([[0.5, 0.0]]))
        array([[0.0189, 0.    , 0.28  ]])
    """

    equations: Equations

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """The fields of the stratum that together have these rates, added up."""
        described = self.equations
        of = described.system.stratum_of
        on = [name for name in of if of[name] == stratum and name in described.swings]
        directions = np.array([described.swings[name] for name in on])
        twists = np.array([described.twists[name] for name in on])
        return rates @ np.linalg.pinv(directions) @ twists


@dataclass(frozen=True)
class QuasiStaticTwists:
    """Contact kinematics: the feet slide as little as dry friction under load allows.

    Three feet are loaded by statics alone. On more the loads are those of springs, and
    the engine's soft contacts let them depend on how fast the feet slide.

    Example:
        >>> import numpy as np
        >>> from models import Ground, Kinematics, QuasiStaticTwists, load
        >>> ground = Ground(np.full(6, 1e-6), np.full(6, 1e3), 1.0, weight=12.5)
        >>> twists = QuasiStaticTwists(Kinematics(load("hexapod")), ground)
        >>> twists("1", np.zeros((1, 2)), np.array([[1.0, 0.0]])).round(6)
        array([[0.0378, 0.    , 0.56  ]])
    """

    kinematics: Kinematics
    ground: Ground
    swing_speed: float = 0.0  # [rad/s], of the fastest joint; 0 for Coulomb's law
    grip: tuple[float, float] | None = None  # of friction, along and across the legs

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """Least dissipation under the loads at the actual angles of the legs."""
        robot = self.kinematics.robot
        on = robot.planted(stratum)
        stance = self.kinematics.stance(swing, legs=on)
        moved = stance.rates * rates[..., robot.group_of_leg[on], None]
        grip, ground = None, self.ground.under(on)
        if self.grip is not None:
            across = stance.rates / np.linalg.norm(stance.rates, axis=-1, keepdims=True)
            grip = ellipses(across, self.grip[::-1])
        if on.sum() <= 3:
            loads = static_loads(stance.feet, stance.center_of_mass) * ground.shares
            return least_dissipation_twist(stance.feet, moved, loads, grip)
        fastest = np.abs(rates * robot.largest_gain).max(axis=-1, keepdims=True)
        unit = np.where(fastest > 0, fastest, 1.0)
        per_radian = moved / unit[..., None]
        twist, _ = sliding_twist(stance, per_radian, ground, self.swing_speed, grip)
        return twist * unit


@dataclass(frozen=True)
class MeasuredField:
    """One field of one stratum, measured from one end of its swing to the other."""

    stratum: str
    direction: tuple[float, ...]  # what one unit of it does to the groups' angles
    span: float  # the swing went from -span to span [rad]
    twist: tuple[Polynomial, Polynomial, Polynomial]  # per unit, along the swing
    slip: float  # of all feet, during the whole swing [m]
    reach: float = np.inf  # a stroke it was not made from confirms it so far [rad]
    off: float = 0.0  # share of that stroke, up to the span, that it misses

    def __call__(self, way: Array) -> Array:
        """Body twist per unit of the field, constant beyond the span, (..., 3)."""
        inside = np.clip(way, -self.span, self.span)
        return np.stack([part(inside) for part in self.twist], axis=-1)


@dataclass(frozen=True, slots=True)
class FailedField:
    """One field of one stratum that could not be measured."""

    stratum: str
    reason: str  # in words


@dataclass(frozen=True)
class IdentifiedTwists:
    """Sums of measured fields, as if the angles of other groups did not matter.

    Example:
        >>> from models import IdentifiedTwists
        >>> IdentifiedTwists(fields={}).failed
        {}
    """

    fields: Mapping[str, MeasuredField]
    failed: Mapping[str, FailedField] = field(default_factory=dict)

    def __call__(self, stratum: str, swing: Array, rates: Array) -> Array:
        """The fields of the stratum that together have these rates.

        Raises MeasurementError for a field that could not be measured, or that swings
        farther than it was confirmed.
        """
        for name, failed in self.failed.items():
            if failed.stratum == stratum:
                why = message("unmeasured", name=name, reason=failed.reason)
                raise MeasurementError(why)
        on = {n: f for n, f in self.fields.items() if f.stratum == stratum}
        inverse = np.linalg.pinv(np.array([f.direction for f in on.values()]))
        inputs, ways = (rates @ inverse).T, (swing @ inverse).T  # (fields, N)
        parts = []
        for (name, f), u, w in zip(on.items(), inputs, ways, strict=True):
            farthest = np.abs(w[u != 0.0]).max(initial=0.0)
            if farthest > f.reach + 1e-6:  # [rad], of rounding
                facts = {"angle": farthest, "reach": f.reach}
                raise MeasurementError(message("unconfirmed", name=name, **facts))
            parts.append(u[:, None] * f(w))
        return np.sum(parts, axis=0)
