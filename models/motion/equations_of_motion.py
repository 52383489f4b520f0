"""Equations of motion of a body that legs carry over the floor, eqs. (16)-(18).

The configuration is the pose x, y, theta, a swing angle `phi_G` for each group of legs
G that moves as one, and a foot height `height_G` for each. Groups in contact that swing
move the body, those in the air only their own angles. Further fields, numbered after
the groups, raise the groups in the air in order, as g_{1,3} does in eq. (17).
"""

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from planner import StratifiedSystem

Twist = tuple[sp.Expr | float, sp.Expr | float, sp.Expr | float]
"""Forward, left and yaw of the body per unit of a field."""
Direction = tuple[float, ...]  # rate of each group's angle per unit of a field
POSE = sp.symbols("x y theta")
EXACT = 2**53  # up to here floats hold every whole number


@dataclass(frozen=True, slots=True)
class Swing:
    """One way to swing groups of legs on a stratum."""

    stratum: str
    label: str  # after the stratum in the field's name
    direction: Direction
    twist: Twist | None  # of the body, per unit; None for groups in the air

    @property
    def name(self) -> str:
        """Name of the field, as in `g12_1`."""
        return f"g{self.stratum}_{self.label}"


@lru_cache(maxsize=32)  # what is derived from a system is kept with it
def walking_system(
    groups: tuple[str, ...],
    contacts: tuple[tuple[str, str | tuple[str, ...]], ...],
    swings: tuple[Swing, ...],
    *,
    heights: bool = True,
    trailer: float | None = None,
    radius: float = 1.0,
) -> StratifiedSystem:
    """The stratified system of a walking body.

    Contacts are each stratum and the groups that stand there, the bottom first. With
    heights the state holds those of the feet, and the strata have fields that lift. A
    trailer is towed with its axle so far behind a hitch at the body's centre; its
    heading `psi` then follows theta in the state. In the metric every angle counts as
    the way at that radius.
    """
    phi = [sp.Symbol(f"phi_{group}") for group in groups]
    height = {g: sp.Symbol(f"height_{g}") for g in groups} if heights else {}
    still = [*POSE, *([] if trailer is None else [sp.Symbol("psi")]), *phi]
    fields: dict[str, dict[str, list[sp.Expr]]] = {name: {} for name, _ in contacts}
    for swing in swings:
        velocity = _velocity(swing.twist or (0, 0, 0), trailer)
        column = [*velocity, *map(_exact, swing.direction), *[sp.S.Zero] * len(height)]
        fields[swing.stratum][swing.name] = column
    level_sets = {}
    for stratum, standing in contacts if heights else ():
        level_sets[stratum] = tuple(height[g] for g in groups if g in standing)
        lifted = [group for group in groups if group not in standing]
        for number, group in enumerate(lifted, len(groups) + 1):
            raised = [sp.Integer(other == group) for other in groups]
            column = [*[sp.S.Zero] * len(still), *raised]
            fields[stratum][f"g{stratum}_{number}"] = column
    state = (*still, *height.values())
    metric = {str(angle): radius for angle in still[2:]}
    return StratifiedSystem(state, fields, contacts[0][0], level_sets, metric)


def _velocity(twist: Twist, trailer: float | None) -> list[sp.Expr]:
    """Rates of x, y, theta and, where a trailer is towed, psi."""
    forward, left, yaw = map(_exact, twist)
    theta = POSE[2]
    body = turned(forward, left, yaw)
    if trailer is None:
        return body
    behind = theta - sp.Symbol("psi")  # the axle follows the hitch without sideslip
    return [*body, (forward * sp.sin(behind) + left * sp.cos(behind)) / trailer]


def turned(forward: sp.Expr, left: sp.Expr, yaw: sp.Expr) -> list[sp.Expr]:
    """Rates of x, y and theta of a body with that twist."""
    cos, sin = sp.cos(POSE[2]), sp.sin(POSE[2])
    return [forward * cos - left * sin, forward * sin + left * cos, yaw]


def _exact(value: sp.Expr | float) -> sp.Expr:
    """Floats that are whole as integers, so that zeros vanish from the brackets."""
    exact = sp.sympify(value)
    whole = exact.is_Float and float(exact).is_integer() and abs(exact) < EXACT
    return sp.Integer(int(exact)) if whole else exact
