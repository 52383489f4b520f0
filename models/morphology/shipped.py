"""The shapes of the shipped robots: their legs from the numbers in `shapes.toml`."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from math import sqrt
from typing import Any

from models.morphology.mjcf import (
    Leg,
    Morphology,
    Point,
    legs_on_a_circle,
    legs_towards_pivots,
)
from planner.support import require_known, shipped_tables

Legs = Mapping[int, Leg]
SIX, EIGHT = (1, 4, 5), (1, 4, 6, 7)  # legs of the first group
# numbers that every shape has
PLAIN = tuple(item.name for item in fields(Morphology) if item.type is float)
RADIAL_BEARINGS = {1: 30, 2: -30, 3: 90, 4: -90, 5: 150, 6: -150}  # [degrees]


def _pivots(legs: Iterable[int], first: tuple[int, ...], y: float) -> dict[int, Point]:
    return {leg: (0.0, y if leg in first else -y) for leg in legs}


def _pairs(xs: tuple[float, ...], ys: tuple[float, ...]) -> dict[int, Point]:
    """Points left and right, front to back; odd numbers are left."""
    ends = [(x, side * y) for x, y in zip(xs, ys, strict=True) for side in (1, -1)]
    return dict(enumerate(ends, start=1))


def _hexapod(
    kappa: float, pivot: float, outer_x: float, outer_y: float, inner_y: float
) -> Legs:
    feet = _pairs((outer_x, 0.0, -outer_x), (outer_y, inner_y, outer_y))
    return legs_towards_pivots(feet, _pivots(feet, SIX, pivot), kappa)


def _octopod(kappa: float, pivot: float) -> Legs:
    """All feet of the shipped one lie 0.2 m from their tetrapod's pivot."""
    inner = sqrt(0.2**2 - 0.05**2) - 0.06  # [m] from the middle line
    feet = _pairs((0.16, 0.05, -0.05, -0.16), (0.18, inner, inner, 0.18))
    return legs_towards_pivots(feet, _pivots(feet, EIGHT, pivot), kappa)


def _square(xs: tuple[float, ...], foot_y: float, hip_y: float) -> Legs:
    hips, feet = (_pairs(xs, (y,) * len(xs)) for y in (hip_y, foot_y))
    return {leg: Leg(hips[leg], feet[leg]) for leg in feet}


def _radial(circle: float, length: float, pivot: float) -> Legs:
    pivots = _pivots(RADIAL_BEARINGS, SIX, -pivot)
    return legs_on_a_circle(RADIAL_BEARINGS, circle, length, pivots)


LEGS: Mapping[str, Callable[..., Legs]] = {
    "hexapod": _hexapod,
    "hexapod-parallel": lambda outer_x, **ys: _square((outer_x, 0.0, -outer_x), **ys),
    "hexapod-radial": _radial,
    "hexapod-classroom": lambda **numbers: {
        number: Leg(leg.hip, leg.foot) for number, leg in _radial(**numbers).items()
    },
    "octopod": _octopod,
    "quadruped": lambda front_x, rear_x, **ys: _square((front_x, rear_x), **ys),
}  # the legs of each shipped robot from the numbers of its shape


def _shape(name: str, like: Mapping[str, Any], own: Mapping[str, Any]) -> Morphology:
    """A robot that is like another but for some numbers.

    Its servos' damping is critical for armature and leg together: the hexapod's leg,
    0.045 kg within 0.105 m, adds a tenth to its armature.
    """
    numbers = {**like, **own, "name": name, "legs": LEGS[name](**own["legs"])}
    damping = 2 * sqrt(numbers["stiffness"] * 1.1 * numbers["armature"])
    for key in ("plate", "lift_range"):
        numbers[key] = tuple(numbers[key])
    return Morphology(damping=damping, **numbers)


_TABLES = shipped_tables("models.morphology", "shapes.toml")
SHAPES = {name: _shape(name, _TABLES["hexapod"], own) for name, own in _TABLES.items()}
MORPHOLOGIES = tuple(SHAPES.values())
HEXAPOD = SHAPES["hexapod"]
KAPPA, PIVOT = (_TABLES["hexapod"]["legs"][key] for key in ("kappa", "pivot"))
FEET = {number: leg.foot for number, leg in HEXAPOD.legs.items()}
PIVOTS = _pivots(FEET, SIX, PIVOT)


def geometry_of(robot: str) -> dict[str, float]:
    """Numbers of a shipped robot's shape by name, SI units and radians."""
    plain = {name: float(getattr(SHAPES[robot], name)) for name in PLAIN}
    return {**_TABLES[robot]["legs"], **plain}


def reshaped(robot: str, geometry: Mapping[str, float]) -> Morphology:
    """The shape of a shipped robot with other numbers; ValueError where none is."""
    known = geometry_of(robot)
    for name, value in geometry.items():
        require_known(f"geometry.{name}", name, known)
        if not abs(value) <= (most := 1000.0 * abs(known[name])):
            raise ValueError(f"geometry.{name} = {value} is beyond {most:g}")
        if name in PLAIN and value <= 0:
            raise ValueError(f"geometry.{name} = {value} is not above 0")
    numbers: dict[str, Any] = {**known, **geometry}
    own = {name: numbers.pop(name) for name in _TABLES[robot]["legs"]}
    return replace(SHAPES[robot], legs=LEGS[robot](**own), **numbers)
