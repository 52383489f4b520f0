"""Finger gaiting: the paper's extension to hands, with contacts as strata."""

from __future__ import annotations

from math import pi

import sympy as sp

from models.systems.problem import Problem
from planner import StratifiedSystem


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
    strata = {numbers: _fields(state, numbers, numbers, reach)}
    steps = [numbers.replace(up, "") for up in numbers]
    for stratum in steps:
        strata[stratum] = _fields(state, numbers, stratum, reach)
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


def _fields(
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
