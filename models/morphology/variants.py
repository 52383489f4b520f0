"""Shipped robots with other numbers: a shape follows from a few of them.

A variant has the legs, groups and gait of the shipped robot. Its equations of motion
follow from the new shape.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from inspect import signature
from math import isfinite
from typing import Any

from models.morphology.dimensions import (
    Leg,
    Morphology,
    Point,
    legs_on_a_circle,
    legs_towards_pivots,
)
from models.morphology.shipped import (
    CLASSROOM_PIVOT,
    KAPPA,
    MORPHOLOGIES,
    OCTOPOD_FEET,
    PIVOT,
    RADIAL_BEARINGS,
)
from planner.support import unknown

Legs = Mapping[int, Leg]
SIX, EIGHT = (1, 4, 5), (1, 4, 6, 7)  # legs of the first group
PLAIN = tuple(item.name for item in fields(Morphology) if item.type == "float")
"""Numbers that every shape has."""


def _pivots(
    legs: Mapping[int, object], first: tuple[int, ...], y: float
) -> dict[int, Point]:
    return {leg: (0.0, y if leg in first else -y) for leg in legs}


def _pairs(xs: tuple[float, ...], ys: tuple[float, ...]) -> dict[int, Point]:
    """Points left and right, front to back; odd numbers are left."""
    ends = [(x, side * y) for x, y in zip(xs, ys, strict=True) for side in (1, -1)]
    return dict(enumerate(ends, start=1))


def _hexapod(
    kappa: float = KAPPA,
    pivot: float = PIVOT,
    outer_x: float = 0.15,
    outer_y: float = 0.18,
    inner_y: float = 0.12,
) -> Legs:
    feet = _pairs((outer_x, 0.0, -outer_x), (outer_y, inner_y, outer_y))
    return legs_towards_pivots(feet, _pivots(feet, SIX, pivot), kappa)


def _parallel(
    outer_x: float = 0.15, foot_y: float = 0.15, hip_y: float = 0.045
) -> Legs:
    xs = (outer_x, 0.0, -outer_x)
    hips, feet = _pairs(xs, (hip_y,) * 3), _pairs(xs, (foot_y,) * 3)
    return {leg: Leg(hips[leg], feet[leg]) for leg in feet}


def _radial(circle: float = 0.08, length: float = 0.11, pivot: float = 0.05) -> Legs:
    pivots = _pivots(RADIAL_BEARINGS, SIX, -pivot)
    return legs_on_a_circle(RADIAL_BEARINGS, circle, length, pivots)


def _classroom(
    circle: float = 0.06, length: float = 0.06, pivot: float = CLASSROOM_PIVOT
) -> Legs:
    legs = _radial(circle, length, pivot)
    return {number: Leg(leg.hip, leg.foot) for number, leg in legs.items()}


def _octopod(kappa: float = KAPPA, pivot: float = 0.06) -> Legs:
    pivots = _pivots(OCTOPOD_FEET, EIGHT, pivot)
    return legs_towards_pivots(OCTOPOD_FEET, pivots, kappa)


def _quadruped(
    front_x: float = 0.08,
    rear_x: float = -0.05,
    foot_y: float = 0.12,
    hip_y: float = 0.02,
) -> Legs:
    hips, feet = (_pairs((front_x, rear_x), (y, y)) for y in (hip_y, foot_y))
    return {leg: Leg(hips[leg], feet[leg]) for leg in feet}


LEGS: Mapping[str, Callable[..., Legs]] = {
    "hexapod": _hexapod,
    "hexapod-parallel": _parallel,
    "hexapod-radial": _radial,
    "hexapod-classroom": _classroom,
    "octopod": _octopod,
    "quadruped": _quadruped,
}
"""Legs of each shipped robot, from the numbers of its shape."""


def geometry_of(robot: str) -> dict[str, float]:
    """Numbers of a shipped robot's shape by name, SI units and radians.

    Args:
        robot: Its name.

    Raises:
        KeyError: If it has no shape that is made from numbers.
    """
    shape = next(shape for shape in MORPHOLOGIES if shape.name == robot)
    legs = signature(LEGS[robot]).parameters
    own = {name: float(number.default) for name, number in legs.items()}
    return own | {name: float(getattr(shape, name)) for name in PLAIN}


def reshaped(robot: str, geometry: Mapping[str, float]) -> Morphology:
    """The shape of a shipped robot with other numbers.

    Args:
        robot: Its name.
        geometry: Numbers that differ, by the names that `geometry_of` gives.

    Raises:
        ValueError: If there is no such number, or no such shape.
    """
    known = geometry_of(robot)
    for name, value in geometry.items():
        if name not in known:
            raise ValueError(f"geometry.{name} {unknown(name, known)}")
        if not isfinite(value):
            raise ValueError(f"geometry.{name} = {value} is not finite")
    numbers = {**known, **geometry}
    plain: dict[str, Any] = {name: numbers[name] for name in PLAIN}
    legs = LEGS[robot](**{n: v for n, v in numbers.items() if n not in plain})
    shape = next(shape for shape in MORPHOLOGIES if shape.name == robot)
    if bad := [name for name, value in plain.items() if value <= 0]:
        raise ValueError(f"geometry.{bad[0]} = {plain[bad[0]]} is not above 0")
    return replace(shape, legs=legs, **plain)
