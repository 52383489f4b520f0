"""Equations of motion of a body that legs carry over the floor, eqs. (16)-(18).

Configuration: x, y, theta, a swing angle `phi_G` for each group of legs G that moves as
one, and a foot height `height_G` for each. The field `gS_i` swings group i on stratum
S: a group in contact moves the body, one in the air only its own angle. Fields numbered
beyond the groups raise those in the air, in order, as g_{1,3} does in eq. (17).

How far a swing moves the body is given here, not derived.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from planner import StratifiedSystem

Twist = tuple[Any, Any, Any]  # numbers or expressions: forward, left, yaw per radian
Strata = Mapping[str, Mapping[str, Twist | None]]
POSE = sp.symbols("x y theta")


def walker(
    strata: Strata,
    *,
    heights: bool = True,
    trailer: float | None = None,
) -> StratifiedSystem:
    """The stratified system of a walking body.

    Args:
        strata: For each stratum, the bottom one first, the body twist that each group
            in contact gives when it swings, None if it cannot swing there; the bottom
            stratum has every group.
        heights: Whether the state holds foot heights, and the strata lift fields.
        trailer: Distance from a hitch at the body's centre to the axle of a trailer,
            whose heading `psi` then follows theta in the state; None tows none.
    """
    bottom = next(iter(strata))
    phi = {group: sp.Symbol(f"phi_{group}") for group in strata[bottom]}
    height = {group: sp.Symbol(f"height_{group}") for group in strata[bottom]}
    towed = () if trailer is None else (sp.Symbol("psi"),)
    joints = (*phi.values(), *(height.values() if heights else ()))
    still: Twist = (0, 0, 0)

    def field(twist: Twist, joint: sp.Symbol) -> list[sp.Expr]:
        moved = [sp.Integer(joint == other) for other in joints]
        return [*_velocity(twist, trailer), *moved]

    def fields(stratum: str) -> dict[str, list[sp.Expr]]:
        twists = strata[stratum]
        swings = [(twists.get(group, still), phi[group]) for group in phi]
        lifts = [(still, height[g]) for g in phi if g not in twists and heights]
        return {
            f"g{stratum}_{i}": field(twist, joint)
            for i, (twist, joint) in enumerate([*swings, *lifts], start=1)
            if twist is not None
        }

    return StratifiedSystem(
        state=(*POSE, *towed, *joints),
        strata={stratum: fields(stratum) for stratum in strata},
        bottom=bottom,
        level_sets={s: tuple(height[g] for g in strata[s]) for s in strata}
        if heights
        else {},
    )


def _velocity(twist: Twist, trailer: float | None) -> list[sp.Expr]:
    """Rates of x, y, theta and, where a trailer is towed, psi."""
    forward, left, yaw = map(sp.sympify, twist)
    theta = POSE[2]
    cos, sin = sp.cos(theta), sp.sin(theta)
    body = [forward * cos - left * sin, forward * sin + left * cos, yaw]
    if trailer is None:
        return body
    behind = theta - sp.Symbol("psi")  # the axle follows the hitch without sideslip
    return [*body, (forward * sp.sin(behind) + left * sp.cos(behind)) / trailer]
