"""The equations of motion of a robot on its strata, eqs. (16)-(18), from its card.

Configuration: x, y, theta, one swing angle `phi_G` and one foot height `height_G` for
each group. The field `gS_i` swings group i on stratum S; fields numbered beyond the
groups raise those in the air, in order, as g_{1,3} does in eq. (17).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import sympy as sp

from models.dissipation import least_dissipation_twist
from models.errors import ModelError
from models.kinematics import Kinematics
from models.loads import static_loads
from models.robot import Robot
from planner.strata import StratifiedSystem

Fields = Literal["paper", "lifted"]
Twist = tuple[float, float, float]  # forward, left [m/rad], yaw [rad/rad]


@dataclass(frozen=True, slots=True)
class Equations:
    """A robot as a stratified system, with the elements to steer it by."""

    system: StratifiedSystem
    elements: tuple[str, ...]
    twists: Mapping[str, Twist]  # of each group's swing while it stands
    swings: Mapping[str, int]  # field -> index of the group whose angle it moves


def equations(robot: Robot, fields: Fields = "lifted") -> Equations:
    """The stratified system of a robot with constant stride and yaw gain.

    Args:
        robot: Robot to describe.
        fields: `paper` steers with loaded tripods swinging on the bottom stratum,
            `lifted` never lets a loaded tripod swing against another one.
    """
    twists = {group: ideal_twist(robot, group) for group in robot.groups}
    system = stratified_system(robot, twists)
    swings = {
        f"g{stratum}_{i + 1}": i for stratum in _strata(robot) for i in range(len(robot.groups))
    }
    return Equations(system, elements(robot, fields), twists, swings)


def ideal_twist(robot: Robot, group: str) -> Twist:
    """Body twist per radian of one group's swing at angle 0, that group alone standing.

    The card's claim where it makes one, contact kinematics otherwise.
    """
    claimed = robot.card.groups[group].twist
    if claimed is not None:
        return claimed
    on = robot.planted(group)
    stance = Kinematics(robot).stance(np.zeros((1, len(robot.groups))))
    feet, rates = stance.feet[:, on], stance.rates[:, on]
    loads = static_loads(feet, stance.center_of_mass)
    if (loads > 1e-9).sum() < 3:
        raise ModelError(
            f"group {group} does not stand alone: {robot.path}; give its twist"
        )
    forward, left, yaw = least_dissipation_twist(feet, rates, loads)[0]
    return (_clean(forward), _clean(left), _clean(yaw))


def _clean(value: float) -> float:
    """Round away the last digits, which are the solver's and not the robot's."""
    return round(float(value), 12) + 0.0


def stratified_system(robot: Robot, twists: Mapping[str, Twist]) -> StratifiedSystem:
    """Fields of every stratum: all combinations of groups in contact."""
    x, y, theta = sp.symbols("x y theta")
    phi = {g: sp.Symbol(f"phi_{g}") for g in robot.groups}
    height = {g: sp.Symbol(f"height_{g}") for g in robot.groups}
    state = (x, y, theta, *phi.values(), *height.values())
    body = {g: _body_velocity(twist, theta) for g, twist in twists.items()}

    def field(velocity: tuple[sp.Expr, ...], moved: sp.Symbol) -> sp.Matrix:
        return sp.Matrix([*velocity, *(int(s == moved) for s in state[3:])])

    def fields_of(stratum: str) -> dict[str, sp.Matrix]:
        still = (sp.S.Zero,) * 3
        swings = [field(body[g] if g in stratum else still, phi[g]) for g in robot.groups]
        lifts = [field(still, height[g]) for g in robot.groups if g not in stratum]
        return {f"g{stratum}_{i}": f for i, f in enumerate(swings + lifts, start=1)}

    names = _strata(robot)
    return StratifiedSystem(
        state=state,
        strata={name: fields_of(name) for name in names},
        bottom=robot.card.bottom,
        level_sets={name: tuple(height[g] for g in robot.groups if g in name) for name in names},
    )


def _body_velocity(twist: Twist, theta: sp.Symbol) -> tuple[sp.Expr, ...]:
    forward, left, yaw = (sp.Float(c) if c else sp.S.Zero for c in twist)
    cos, sin = sp.cos(theta), sp.sin(theta)
    return (forward * cos - left * sin, forward * sin + left * cos, yaw)


def _strata(robot: Robot) -> tuple[str, ...]:
    """The gait's strata, bottom first, each once; nothing beyond what the card walks."""
    return tuple(dict.fromkeys((robot.card.bottom, *robot.card.gait)))


def elements(robot: Robot, fields: Fields) -> tuple[str, ...]:
    """Names of the fields and brackets to steer two alternating groups with."""
    if len(robot.groups) != 2:
        raise ModelError(f"{len(robot.groups)} groups: {robot.path}; two can be steered")
    first, second = robot.groups
    loaded = {
        "paper": (f"g{robot.card.bottom}_1", f"g{robot.card.bottom}_2"),
        "lifted": (f"g{first}_1", f"g{second}_2"),
    }[fields]
    return (*loaded, f"g{first}_2", f"g{second}_1", f"[{loaded[0]},{loaded[1]}]")
