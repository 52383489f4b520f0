"""Smooth systems of as many coordinates as asked for: trailers, and chained forms.

They have one stratum: the method is that of Sec. 2.1, as no contact changes.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import sympy as sp

from models.systems.problem import Problem, State
from planner import StratifiedSystem
from planner.planning import FlatOutputs

ONLY = "0"  # the one stratum, without contacts that change
MOST_TRAILERS = 3  # words of degree 3 + trailers double in length with each degree
LONGEST_CHAIN = 8  # likewise


def car_with_trailers(trailers: int = 1, length: float = 1) -> Problem:
    """A car with 1 to 3 trailers, each hitched to the axle before it at that distance.

    Every trailer asks for one degree more, and for shorter steps by far. The flat
    output is the middle of the last axle: where it goes, all before it must steer.
    """
    if not 1 <= trailers <= MOST_TRAILERS:
        remedy = f"give 1 to {MOST_TRAILERS}, or use the system car"
        raise ValueError(f"trailers is {trailers}; {remedy}")
    x, y, phi = sp.symbols("x y phi")
    headings = sp.symbols(f"theta_0:{trailers + 1}")
    following, speed = [], sp.S.One  # of the axle before
    for before, heading in pairwise(headings):
        following.append(speed * sp.sin(before - heading) / length)
        speed *= sp.cos(before - heading)
    forward = [sp.cos(headings[0]), sp.sin(headings[0]), sp.tan(phi) / length]
    drive, steer = [*forward, *following, 0], [*[0] * (3 + trailers), 1]
    back, aside = (sp.Add(*map(part, headings[1:])) for part in (sp.cos, sp.sin))
    parked = smooth(
        name="car-trailers",
        description="a car with trailers, parked sideways; each adds 1 to the degree",
        state=["x", "y", *map(str, headings), "phi"],
        fields={"drive": drive, "steer": steer},
        goal={"y": 0.01},
        segments=4,
    )
    flat = FlatOutputs(along=x - length * back, across=y - length * aside)
    hitches = tuple(before - heading for before, heading in pairwise(headings))
    return replace(parked, flat=flat, hitches=hitches)


def chained(size: int = 5) -> Problem:
    """The chained form x1' = u1, x2' = u2, x3' = x2 u1, x4' = x3 u1, and so on.

    It has 3 to 8 coordinates; the last asks for brackets of one degree less.
    """
    if not 3 <= size <= LONGEST_CHAIN:
        raise ValueError(f"size is {size}; a chain has 3 to {LONGEST_CHAIN}")
    x = sp.symbols(f"x1:{size + 1}")
    return smooth(
        name="chained",
        description="a chained form, along its last coordinate; nilpotent",
        state=list(map(str, x)),
        fields={"g1": [1, 0, *x[1:-1]], "g2": [0, 1, *[0] * (size - 2)]},
        goal={str(x[-1]): 1},
    )


def smooth(
    name: str,
    description: str,
    state: Sequence[str],
    fields: dict[str, Sequence[sp.Expr | float]],
    goal: State,
    segments: int = 1,
) -> Problem:
    """A system with two fields on one stratum, steered with brackets of both.

    Its elements are the fields and the brackets of the second with the first, again and
    again, as many as there are coordinates. The rest is as in `Problem`.
    """
    first, second = fields
    nested = [second]
    while len(nested) < len(state) - 1:
        nested.append(f"[{first},{nested[-1]}]")
    return Problem(
        name=name,
        description=description,
        system=StratifiedSystem(tuple(map(sp.Symbol, state)), {ONLY: fields}, ONLY),
        gait=(ONLY,),
        elements=(first, *nested),
        goal=goal,
        segments=segments,
    )
