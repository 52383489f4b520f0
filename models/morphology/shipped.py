"""The lengths and masses of the shipped robots, each with its source or derivation.

`python -m scripts.write_robots` writes the MJCF files from them. The legs of a robot
follow from a few numbers of its shape, of which a variant has others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from inspect import signature
from math import isfinite, sqrt
from typing import Any

from models.morphology.mjcf import (
    Leg,
    Morphology,
    Point,
    legs_on_a_circle,
    legs_towards_pivots,
)
from planner.support import unknown

Legs = Mapping[int, Leg]
SIX, EIGHT = (1, 4, 5), (1, 4, 6, 7)  # legs of the first group
# numbers that every shape has
PLAIN = tuple(item.name for item in fields(Morphology) if item.type == "float")


def _pivots(legs: Iterable[int], first: tuple[int, ...], y: float) -> dict[int, Point]:
    return {leg: (0.0, y if leg in first else -y) for leg in legs}


def _pairs(xs: tuple[float, ...], ys: tuple[float, ...]) -> dict[int, Point]:
    """Points left and right, front to back; odd numbers are left."""
    ends = [(x, side * y) for x, y in zip(xs, ys, strict=True) for side in (1, -1)]
    return dict(enumerate(ends, start=1))


# Hexapod: tripod 1 is legs 1, 4, 5 and tripod 2 is legs 2, 3, 6, as in Section 6. All
# six feet lie 0.1875 m from their tripod's pivot (a 3-4-5 triangle).
PIVOT = 0.0675  # R [m]
KAPPA = 0.56  # yaw gain [rad/rad]; stride = KAPPA * PIVOT = 0.0378 m/rad
FEET = _pairs((0.15, 0.0, -0.15), (0.18, 0.12, 0.18))
PIVOTS = _pivots(FEET, SIX, PIVOT)


def _hexapod(
    kappa: float = KAPPA,
    pivot: float = PIVOT,
    outer_x: float = 0.15,
    outer_y: float = 0.18,
    inner_y: float = 0.12,
) -> Legs:
    feet = _pairs((outer_x, 0.0, -outer_x), (outer_y, inner_y, outer_y))
    return legs_towards_pivots(feet, _pivots(feet, SIX, pivot), kappa)


# A loaded leg may sag by 0.1 mm at the foot: the middle foot of a tripod carries 0.6 of
# 12.5 N on an arm of 0.105 m, and 7.5 N * (0.105 m)^2 / 0.1 mm = 830 N m/rad. What the
# walk departs from its quasi-static prediction falls as one over this stiffness.
STIFFNESS = 1000.0
# A 12-servo hobby robot's gear train: 300 : 1 on a coreless rotor of 2e-8 kg m^2.
ARMATURE = 300**2 * 2e-8
# Critical for armature and leg together (0.045 kg within 0.105 m adds a tenth to it).
DAMPING = 2 * sqrt(STIFFNESS * 1.1 * ARMATURE)

HEXAPOD = Morphology(
    name="hexapod",
    legs=_hexapod(),
    hip_height=0.06,
    plate=(0.085, 0.13, 0.008),
    body_mass=1.0,
    leg_mass=0.045,
    leg_radius=0.006,
    hip_radius=0.010,  # with the leg's radius under 18 mm: neighbours clear at 0.45 rad
    foot_radius=0.008,
    swing_range=0.45,
    lift_range=(-0.1, 0.6),
    stiffness=STIFFNESS,
    damping=DAMPING,
    armature=ARMATURE,
)


def _square(xs: tuple[float, ...], foot_y: float, hip_y: float) -> Legs:
    hips, feet = (_pairs(xs, (y,) * len(xs)) for y in (hip_y, foot_y))
    return {leg: Leg(hips[leg], feet[leg]) for leg in feet}


def _parallel(
    outer_x: float = 0.15, foot_y: float = 0.15, hip_y: float = 0.045
) -> Legs:
    return _square((outer_x, 0.0, -outer_x), foot_y, hip_y)


SHAPES: dict[str, tuple[Morphology, Callable[..., Legs]]] = {
    "hexapod": (HEXAPOD, _hexapod)
}
"""Each shipped robot, and its legs from the numbers of its shape."""


def _ship(name: str, legs: Callable[..., Legs], **numbers: Any) -> None:
    """A robot that is like the hexapod but for its legs and some numbers."""
    SHAPES[name] = replace(HEXAPOD, name=name, legs=legs(), **numbers), legs


# The paper's Figs. 1 and 5 taken literally: legs square to the body.
_ship("hexapod-parallel", _parallel, plate=(0.17, 0.06, 0.008))

# Educational hexapods carry six equal legs of two servos at 60 degrees on a round body.
# Radial legs can only turn it about its middle. Where it stands with the outer legs
# turned by 22 degrees, each tripod's lines meet at a pivot 0.05 m off the middle.
RADIAL_BEARINGS = {1: 30, 2: -30, 3: 90, 4: -90, 5: 150, 6: -150}  # [degrees]


def _radial(circle: float = 0.08, length: float = 0.11, pivot: float = 0.05) -> Legs:
    pivots = _pivots(RADIAL_BEARINGS, SIX, -pivot)
    return legs_on_a_circle(RADIAL_BEARINGS, circle, length, pivots)


_ship("hexapod-radial", _radial, plate=(0.075, 0.075, 0.008))

# The table-top robot of classrooms: twelve MG90-class servos in printed parts, six
# equal radial legs on a round body, such as the Vorpal (vorpalrobotics.com/wiki).
# Masses: a servo weighs 13.4 g (data sheet of the MG90S), a cell 48.5 g (Panasonic
# NCR18650B); six swing servos and two cells are 177 g, the printed body and the
# electronics are taken as 123 g, the printed leg with its lift servo as 25 g. Sizes
# are not published: legs of 60 mm on hips 60 mm from the middle are taken, so that
# feet stand on a circle of 0.24 m.
# As such robots are sold, with legs straight out, they walk and turn and cannot step
# sideways. Here the horns are mounted turned, so that each tripod has a pivot: where
# its inner leg swings half as far as the outer ones, which keeps all of them on counts.
CLASSROOM_PIVOT = 0.044559963  # 0.0754 m from the inner foot, 0.1509 m from the others
CLASSROOM_STIFFNESS = 200.0  # of ideal servos; a leg sags by a thousandth of a radian
CLASSROOM_ARMATURE = 240**2 * 4e-9  # 30,000 rpm to 13 rad/s; a rotor of 7 mm


def _classroom(
    circle: float = 0.06, length: float = 0.06, pivot: float = CLASSROOM_PIVOT
) -> Legs:
    legs = _radial(circle, length, pivot)
    return {number: Leg(leg.hip, leg.foot) for number, leg in legs.items()}


_ship(
    "hexapod-classroom",
    _classroom,
    hip_height=0.045,
    plate=(0.055, 0.055, 0.006),
    body_mass=0.30,
    leg_mass=0.025,
    leg_radius=0.004,
    foot_radius=0.007,
    stiffness=CLASSROOM_STIFFNESS,
    damping=2 * sqrt(CLASSROOM_STIFFNESS * 1.1 * CLASSROOM_ARMATURE),
    armature=CLASSROOM_ARMATURE,
)

# Two tetrapods, 1-4-6-7 and 2-3-5-8: the tripods with two inner legs each. All
# feet lie 0.2 m from their tetrapod's pivot.
OCTOPOD_INNER = sqrt(0.2**2 - 0.05**2) - 0.06  # [m] from the middle line
OCTOPOD_FEET = _pairs(
    (0.16, 0.05, -0.05, -0.16), (0.18, OCTOPOD_INNER, OCTOPOD_INNER, 0.18)
)


def _octopod(kappa: float = KAPPA, pivot: float = 0.06) -> Legs:
    pivots = _pivots(OCTOPOD_FEET, EIGHT, pivot)
    return legs_towards_pivots(OCTOPOD_FEET, pivots, kappa)


_ship("octopod", _octopod, body_mass=1.2, swing_range=0.4)


def _quadruped(
    front_x: float = 0.08,
    rear_x: float = -0.05,
    foot_y: float = 0.12,
    hip_y: float = 0.02,
) -> Legs:
    return _square((front_x, rear_x), foot_y, hip_y)


# In proportion like HAMR, the ambulatory micro-robot of swing-and-lift legs, at four
# times its length: four equal legs square to the body, farther out than apart. Its
# weight lies 15 mm behind the middle of its feet, not on the line between any two: a
# front leg can lift at any time, and a hind leg when a front one stands far back.
_ship(
    "quadruped",
    _quadruped,
    hip_height=0.05,
    plate=(0.09, 0.025, 0.008),
    body_mass=0.6,
    leg_mass=0.03,
    swing_range=0.55,
)
MORPHOLOGIES = tuple(shape for shape, _ in SHAPES.values())


def geometry_of(robot: str) -> dict[str, float]:
    """Numbers of a shipped robot's shape by name, SI units and radians."""
    shape, legs = SHAPES[robot]
    own = {name: p.default for name, p in signature(legs).parameters.items()}
    plain = {name: getattr(shape, name) for name in PLAIN}
    return {name: float(value) for name, value in {**own, **plain}.items()}


def reshaped(robot: str, geometry: Mapping[str, float]) -> Morphology:
    """The shape of a shipped robot with other numbers; ValueError where none is."""
    known = geometry_of(robot)
    for name, value in geometry.items():
        if name not in known:
            raise ValueError(f"geometry.{name} {unknown(name, known)}")
        if not isfinite(value):
            raise ValueError(f"geometry.{name} = {value} is not finite")
        if name in PLAIN and value <= 0:
            raise ValueError(f"geometry.{name} = {value} is not above 0")
    shape, legs = SHAPES[robot]
    numbers: dict[str, Any] = {**known, **geometry}
    own = {name: numbers.pop(name) for name in signature(legs).parameters}
    return replace(shape, legs=legs(**own), **numbers)
