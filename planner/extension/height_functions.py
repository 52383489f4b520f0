"""Stratified panels: the bracket of two strokes as a height function over their angles.

Each of two strokes moves one shape coordinate, on its own stratum or on the same one.
Going around a rectangle of the two angles, switching strata at its corners, is the word
of their bracket. Where the rates of a coordinate are functions of the two angles alone,
its net change is by Green's theorem exactly the integral of its height function, the
curl of these rates, over the rectangle; at the start the height is the bracket itself.
A coordinate whose height is zero, such as the heading of a body that its strokes turn
at constant rates, is a function of the angles and is put in its place in the others.

The name is that of Prasad, Hatton and Jayaram, "Geometric Mechanics of
Contact-Switching Systems" (RA-L 2023).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.polynomial.legendre import leggauss

from planner.errors import message, require_known
from planner.numerics.arrays import Array
from planner.systems.fields import NumericField
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

Rates = tuple[sp.Expr, sp.Expr]


@dataclass(frozen=True, eq=False)
class StratifiedPanels:
    """Height functions of two strokes, one for each coordinate that is no angle."""

    strokes: tuple[str, str]  # the field that is run first in front
    strata: tuple[str, str]  # of each
    angles: tuple[sp.Symbol, sp.Symbol]  # the shape coordinate that each moves
    speeds: tuple[float, float]  # rate of the angle along each
    rates: Mapping[str, Rates]  # change of each other coordinate per unit of angle
    heights: Mapping[str, sp.Expr]  # its height function, per unit of area

    def at(self, coordinate: str, first: Array, second: Array) -> Array:
        """Height function of a coordinate at pairs of angles of the two strokes."""
        require_known(f"panel {coordinate}", coordinate, self.heights)
        values = self._functions[coordinate](first, second)
        return np.broadcast_to(values, np.shape(first)).astype(float)

    def change(
        self, coordinate: str, low: Sequence[float], by: Sequence[float]
    ) -> float:
        """Net change of a coordinate around a rectangle: its height, integrated.

        The loop starts at the corner `low` along the side of the first stroke; the
        lengths `by` of both sides may be negative.
        """
        nodes, weights = leggauss(24)  # exact to rounding for sines over some radians
        first, second = (
            start + side * (nodes + 1) / 2 for start, side in zip(low, by, strict=True)
        )
        values = self.at(coordinate, *np.meshgrid(first, second, indexing="ij"))
        return float(weights @ values @ weights) * by[0] * by[1] / 4

    def loop(self, by: Sequence[float]) -> tuple[Flow, Flow, Flow, Flow]:
        """The flows around a rectangle of given sides, the word of the bracket."""
        (f, g), (on_f, on_g) = self.strokes, self.strata
        a, b = (side / speed for side, speed in zip(by, self.speeds, strict=True))
        return Flow(on_f, f, a), Flow(on_g, g, b), Flow(on_f, f, -a), Flow(on_g, g, -b)

    @cached_property
    def _functions(self) -> dict[str, sp.Expr]:
        return {n: sp.lambdify(self.angles, h, np) for n, h in self.heights.items()}


def stratified_panels(
    system: StratifiedSystem,
    strokes: tuple[str, str],
    start: Mapping[str, float] | None = None,
) -> StratifiedPanels:
    """Height functions of two strokes over the two angles that they move.

    Strokes are named by two fields, each of which moves one shape coordinate. `start`
    has coordinates where both angles are zero, by name; those not named are zero.

    Raises:
        ValueError: A field is unknown or a Python function, moves no shape coordinate
            of its own, or a coordinate's rates depend on more than the two angles.

    Example:
        >>> from planner import StratifiedSystem, stratified_panels
        >>> fields = {"1": {"f": [0, 1, 0]}, "2": {"g": ["a", 0, 1]}}
        >>> system = StratifiedSystem("z a b", fields, "1")
        >>> stratified_panels(system, ("f", "g")).change("z", low=(0, 0), by=(2, 3))
        6.0
    """
    for name in start or ():
        require_known(f"coordinate {name}", name, [str(s) for s in system.state])
    begin = {s: sp.nsimplify((start or {}).get(str(s), 0.0)) for s in system.state}
    shape = ShapeCoordinates(system)
    functions = [n for n, f in system.fields.items() if isinstance(f, NumericField)]
    if functions:
        raise ValueError(f"field {functions[0]} is a Python function; give formulas")
    for name in strokes:
        require_known(f"field {name}", name, system.fields)
    angles, speeds = _angles(shape, strokes)
    others = [i for i in range(system.dimension) if i not in shape.coordinates]
    still = [i for i in shape.coordinates if i not in angles]
    turning = [i for i in still if any(shape.rates[name][i] for name in strokes)]
    f, g = (
        [entry / speed for entry in system.fields[name]]
        for name, speed in zip(strokes, speeds, strict=True)
    )
    rates = {system.state[i]: (f[i], g[i]) for i in sorted([*others, *turning])}
    symbols = (system.state[angles[0]], system.state[angles[1]])
    known = {(s := system.state[i]): begin[s] for i in still if i not in turning}
    solved = _solved(rates, begin, symbols, known)
    strata = (system.stratum_of[strokes[0]], system.stratum_of[strokes[1]])
    heights = {name: _curl(pair, symbols) for name, pair in solved.items()}
    return StratifiedPanels(strokes, strata, symbols, speeds, solved, heights)


def _angles(
    shape: ShapeCoordinates, strokes: tuple[str, str]
) -> tuple[tuple[int, int], tuple[float, float]]:
    """The shape coordinate that each stroke moves and the other does not."""
    symbols = [f.free_symbols for f in shape.system.fields.values()]
    used = set().union(*symbols)  # an angle of a leg, unlike a heading, is in no rate
    found = []
    for name, other in (strokes, strokes[::-1]):
        own, others = shape.rates[name], shape.rates[other]
        moved = [i for i in shape.coordinates if own[i] and not others[i]]
        if not moved:
            raise ValueError(message("strokes", name=name, other=other))
        found.append(min(moved, key=lambda i: (shape.system.state[i] in used, i)))
    (i, j), (f, g) = found, strokes
    return (i, j), (float(shape.rates[f][i]), float(shape.rates[g][j]))


def _solved(
    rates: Mapping[sp.Symbol, Rates],
    begin: Mapping[sp.Symbol, sp.Expr],
    angles: tuple[sp.Symbol, sp.Symbol],
    known: dict[sp.Symbol, sp.Expr],
) -> dict[str, Rates]:
    """Rates of all coordinates as expressions of the angles, solved one by one."""
    left = dict(rates)
    solved: dict[sp.Symbol, Rates] = {}
    while left:
        found = {s: (f.subs(known), g.subs(known)) for s, (f, g) in left.items()}
        ready = {
            s: (f, g)
            for s, (f, g) in found.items()
            if (f.free_symbols | g.free_symbols) <= set(angles)
        }
        if not ready:
            named, (one, two) = ", ".join(map(str, left)), angles
            raise ValueError(message("two_angles", left=named, one=one, two=two))
        for s, pair in ready.items():
            solved[s] = pair
            del left[s]
            if _curl(pair, angles) == 0:
                known[s] = _potential(pair, angles) + begin[s]
    return {str(s): solved[s] for s in rates}


def _curl(rates: Rates, angles: tuple[sp.Symbol, sp.Symbol]) -> sp.Expr:
    along, across = rates  # the first angle, and the second
    return sp.simplify(sp.diff(across, angles[0]) - sp.diff(along, angles[1]))


def _potential(rates: Rates, angles: tuple[sp.Symbol, sp.Symbol]) -> sp.Expr:
    """The function with these rates that is zero where both angles are."""
    first, second = angles
    s = sp.Dummy()
    along = sp.integrate(rates[0].subs({first: s, second: 0}), (s, 0, first))
    return sp.expand(along + sp.integrate(rates[1].subs(second, s), (s, 0, second)))
