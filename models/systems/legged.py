"""Walkers of few feet beside the hexapod, in units of their own size, and fingers.

This module gives their strata, their body twists and the elements to steer with;
`motion.equations_of_motion` makes their equations from these. Finger gaiting is the
paper's extension to hands, with fingers on a disc for feet on the floor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi

import sympy as sp

from models.motion.equations_of_motion import Swing, Twist, walking_system
from models.systems.problem import Problem
from planner import StratifiedSystem

ALTERNATING = ("12", "1", "12", "2", "12")
AIR_SWINGS = ("g1_2", "g2_1")  # of the group that is up
Strata = Mapping[str, Mapping[str, Twist | None]]
Feet = Mapping[str, Sequence[tuple[float, float]]]  # x, y of each group's feet


def biped(hip: float = 1, heights: bool = True) -> Problem:
    """Two feet that turn about the vertical under their hips, lifted in turn (Fig. 2).

    It walks as one moves a heavy cupboard, by turning the body about the foot that
    stands. With both feet down nothing can move: the bottom stratum has no field.

    Args:
        hip: Distance of each hip from the middle of the body.
        heights: Whether the state holds foot heights.
    """
    left: Twist = (hip, 0, 1)
    right: Twist = (hip, 0, -1)
    system = walker(
        {"12": {"1": None, "2": None}, "1": {"1": left}, "2": {"2": right}},
        heights=heights,
    )
    return Problem(
        name="biped",
        description="two turning feet, as one walks a cupboard; sideways (Fig. 2)",
        system=system,
        gait=ALTERNATING,
        elements=("g1_1", "g2_2", *AIR_SWINGS, "[g1_1,g2_2]"),
        goal={"y": 1},
        segments=16,
    )


def quadruped(length: float = 2, width: float = 1, heights: bool = True) -> Problem:
    """A crawl, one leg at a time in the air: four strata of three feet (Fig. 3).

    All legs push while all feet are down, those of one side against the other's to
    turn, and step forward one by one.

    Args:
        length: Distance between front and rear feet.
        width: Distance between left and right feet.
        heights: Whether the state holds foot heights.
    """
    x, y = sp.sympify(length) / 2, sp.sympify(width) / 2
    feet = {"1": [(x, y)], "2": [(x, -y)], "3": [(-x, y)], "4": [(-x, -y)]}
    steps = ("234", "134", "124", "123")
    pushes = tuple(f"g1234_{leg}" for leg in feet)
    return Problem(
        name="quadruped-crawl",
        description="one leg at a time in the air, four strata of three feet (Fig. 3)",
        system=walker(shared(feet, ("1234", *steps)), heights=heights),
        gait=("1234", *(s for step in steps for s in (step, "1234"))),
        elements=(
            *pushes,
            *(f"g{step}_{leg}" for leg, step in zip(feet, steps, strict=True)),
            "[g1234_1,g1234_2]",
        ),
        goal={"x": 0.5, "y": 0.25},
        segments=16,
    )


def octopod(length: float = 3, width: float = 1, heights: bool = True) -> Problem:
    """Eight legs in two tetrapods whose left and right pairs swing apart.

    Pairs 1 (legs 1, 5) and 4 (legs 4, 8) stand against 2 (2, 6) and 3 (3, 7), odd legs
    on the left, numbered from the front. A tetrapod turns by pushing its two sides
    against each other, so even its bracket needs one stratum only.

    Args:
        length: Distance between the first and the last feet.
        width: Distance between left and right feet.
        heights: Whether the state holds foot heights.
    """
    x, y = sp.sympify(length) / 6, sp.sympify(width) / 2
    feet = {
        "1": [(3 * x, y), (-x, y)],
        "2": [(3 * x, -y), (-x, -y)],
        "3": [(x, y), (-3 * x, y)],
        "4": [(x, -y), (-3 * x, -y)],
    }
    return Problem(
        name="octopod-pairs",
        description="eight legs in two tetrapods, a bracket within one stratum",
        system=walker(shared(feet, ("1234", "14", "23")), heights=heights),
        gait=("1234", "14", "1234", "23", "1234"),
        elements=(
            *("g14_1", "g14_4", "[g14_1,g14_4]"),
            *("g23_1", "g14_2", "g14_3", "g23_4"),
        ),
        goal={"x": 0.5, "y": 0.25},
        segments=16,
    )


def shared(feet: Feet, strata: Sequence[str]) -> Strata:
    """Body twists where all feet in contact share the slip, as in viscous friction.

    Every foot of a group goes backward by one per radian of its swing. The body moves
    so that the squares of the slip velocities of the feet in contact add up to least.
    Strata are named by the groups in contact, the bottom one first.
    """
    return {
        stratum: {group: _twist(feet, stratum, group) for group in stratum}
        for stratum in strata
    }


def _twist(feet: Feet, stratum: str, group: str) -> Twist:
    planted = [(owner, *foot) for owner in stratum for foot in feet[owner]]
    slip = sp.Matrix([row for _, x, y in planted for row in ([1, 0, -y], [0, 1, x])])
    swing = sp.Matrix([v for owner, *_ in planted for v in (int(owner == group), 0)])
    forward, left, yaw = (slip.T * slip).LUsolve(slip.T * swing)
    return (forward, left, yaw)


def walker(
    strata: Strata, *, heights: bool = True, trailer: float | None = None
) -> StratifiedSystem:
    """The stratified system of a walker whose groups swing one by one.

    For each stratum, the bottom one first, the body twist that each group in contact
    gives when it swings; None if it cannot swing there. The bottom stratum has every
    group. Heights and trailer are those of `walking_system`.
    """
    groups = tuple(next(iter(strata.values())))
    swings = [
        Swing(stratum, str(i + 1), _unit(i, len(groups)), twists.get(group))
        for stratum, twists in strata.items()
        for i, group in enumerate(groups)
        if twists.get(group, ()) is not None
    ]
    return walking_system(groups, strata, swings, heights=heights, trailer=trailer)


def _unit(index: int, size: int) -> tuple[float, ...]:
    return tuple(float(i == index) for i in range(size))


def finger_gaiting(fingers: int = 3, reach: float = 1, span: float = 0.5) -> Problem:
    """A disc on a pivot, turned by fingers that each swing along its rim and lift.

    Fingers in contact turn with the disc and none of them slips, so all swing at the
    disc's rate over `reach`. One finger at a time is off the rim to swing back.

    Args:
        fingers: Number of fingers, 2 to 9.
        reach: Turn of the disc per radian of a finger in contact.
        span: Angle that a finger can swing to either side [rad].

    Raises:
        ValueError: There are too few or too many fingers.
    """
    if not 2 <= fingers <= 9:
        raise ValueError(f"fingers is {fingers}; 2 to 9 can walk around a disc")
    numbers = "123456789"[:fingers]
    angles = [sp.Symbol(f"phi_{i}") for i in numbers]
    gaps = [sp.Symbol(f"gap_{i}") for i in numbers]
    state = (sp.Symbol("disc"), *angles, *gaps)
    strata = {numbers: _finger_fields(state, numbers, numbers, reach)}
    steps = [numbers.replace(up, "") for up in numbers]
    for stratum in steps:
        strata[stratum] = _finger_fields(state, numbers, stratum, reach)
    return Problem(
        name="finger-gaiting",
        description="a disc turned once around by fingers that swing and lift",
        system=StratifiedSystem(
            state=state,
            strata=strata,
            bottom=numbers,
            level_sets={
                stratum: tuple(g for g in gaps if str(g)[-1] in stratum)
                for stratum in strata
            },
        ),
        gait=(numbers, *(s for step in steps for s in (step, numbers))),
        elements=(
            f"turn_{numbers}",
            *(f"swing_{stratum}" for stratum in steps),
        ),
        goal={"disc": 2 * pi},
        segments=8,
        limits={str(angle): (-span, span) for angle in angles},
        stance="centred",
    )


def _finger_fields(
    state: tuple[sp.Symbol, ...], fingers: str, stratum: str, reach: float
) -> dict[str, list[sp.Expr]]:
    """Turning the disc, and swinging and lifting the finger that is up."""
    turning = {"disc": reach} | {f"phi_{i}": 1 for i in stratum}
    rates = {f"turn_{stratum}": turning}
    for up in set(fingers) - set(stratum):
        rates[f"swing_{stratum}"] = {f"phi_{up}": 1}
        rates[f"lift_{stratum}"] = {f"gap_{up}": 1}
    return {
        name: [sp.sympify(rate.get(str(symbol), 0)) for symbol in state]
        for name, rate in rates.items()
    }
