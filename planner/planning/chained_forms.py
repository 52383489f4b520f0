"""Systems with two fields that have a chained form, steered exactly in a single plan.

A car with trailers is not nilpotent and its critical step is minute. But its fields can
be combined to others, with factors that depend on the configuration, whose brackets
beyond one degree vanish. In suitable coordinates z these are the chained form

    z1' = u1,  z2' = u2,  z3' = z2 u1,  ...,  zn' = z(n-1) u1,

and words of that degree are exact. The coordinates follow from two functions of the
configuration, the flat outputs: z1 moves along one field only, and every other z is the
slope of the next against z1.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from typing import cast

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from planner.errors import PlannerError, RankError, point
from planner.extension.extended import ExtendedSystem, extend
from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan, plan
from planner.planning.paths import line
from planner.planning.rollouts import play
from planner.systems.fields import NumericField, Symbols, sample_configurations
from planner.systems.strata import StratifiedSystem

AHEAD, TURN = "ahead", "turn"  # the combined fields
NEARBY = 0.3  # of the random configurations at which forms are checked
MET = 1e-6  # distance from the goal to which flows of a chained form are followed
VANISHED = 1e-8  # relative, of what must vanish there


@dataclass(frozen=True)
class FlatOutputs:
    """Two functions of the configuration from which a chained form follows.

    The rate of `along` per unit of the field that moves it, and the slope of `across`
    against `along`, are derived if None. A shorter expression saves time.
    """

    along: sp.Expr  # z1, which one of the two fields leaves alone
    across: sp.Expr  # zn
    rate: sp.Expr | None = None
    slope: sp.Expr | None = None


@dataclass(frozen=True, eq=False)
class ChainedForm:
    """A system in chained form."""

    system: StratifiedSystem  # of the combined fields `ahead` and `turn`, g1 and g2
    coordinates: tuple[sp.Expr, ...]  # z1, ..., zn as expressions in the state

    @cached_property
    def model(self) -> ExtendedSystem:
        """The chained form itself, with the state z and the elements to steer it by."""
        z = sp.symbols(f"z1:{len(self.coordinates) + 1}")
        fields = {AHEAD: [1, 0, *z[1:-1]], TURN: [0, 1, *[0] * (len(z) - 2)]}
        elements = [TURN]
        while len(elements) < len(z) - 1:
            elements.append(f"[{AHEAD},{elements[-1]}]")
        bottom = self.system.bottom
        chain = StratifiedSystem(z, {bottom: fields}, bottom)
        return extend(chain, [AHEAD, *elements])

    @cached_property
    def _value(self) -> Callable[..., list[float]]:
        state, z = self.system.state, self.coordinates
        return cast(
            Callable[..., list[float]], sp.lambdify(state, z, "numpy", cse=True)
        )

    def at(self, x: ArrayLike) -> Array:
        """Coordinates z of a configuration, both of shape (n,)."""
        state = np.asarray(x, dtype=float)
        with np.errstate(all="ignore"):
            z = np.array(self._value(*state), dtype=float)
        if not np.isfinite(z).all():
            raise PlannerError(
                f"the chained form is singular at {point(state)}; plan with elements"
            )
        return z

    def plan(self, start: ArrayLike, goal: ArrayLike, segments: int = 1) -> Plan:
        """Flows of the combined fields from one configuration (n,) exactly to another.

        The segments divide the straight line between them in z, on which the form must
        not be singular.
        """
        ends = line(start, goal)
        straight = line(self.at(ends(0.0)), self.at(ends(1.0)))
        try:
            planned = plan(self.model, straight, segments)
        except RankError:
            raise PlannerError(
                f"the chained form is nearly singular between {point(ends(0.0))} and "
                f"{point(ends(1.0))}; plan with elements"
            ) from None
        nominal = [ends(0.0)]
        for flows in planned.segments():
            nominal.append(play(self.system, flows, nominal[-1])[-1])
        missed = float(np.abs(nominal.pop() - ends(1.0)).max())
        if not missed <= MET:
            raise PlannerError(
                f"flows of the chained form end {missed:.3g} from "
                f"{point(ends(1.0))}: its singularities separate the goal from the "
                "start; plan with elements"
            )
        at = np.array([*nominal, ends(1.0)])
        return replace(planned, system=self.system, nominal=at)


def chained_form(
    system: StratifiedSystem, outputs: FlatOutputs | None = None
) -> ChainedForm:
    """The chained form of a system with one stratum and two fields.

    Pairs of coordinates are tried if no flat outputs are given.
    """
    fields = list(system.fields.values())
    if len(fields) != 2 or any(isinstance(f, NumericField) for f in fields):
        raise PlannerError(
            f"the system has {len(fields)} fields; a chained form has two, by formulas"
        )
    columns = [sp.Matrix(field) for field in fields]
    if outputs is not None:
        return _formed(system, columns, outputs)
    for along, across in permutations(system.state, 2):
        with suppress(PlannerError):
            return _formed(system, columns, FlatOutputs(along, across))
    raise PlannerError(
        "no two coordinates are flat outputs of a chained form; declare functions that "
        "are, or plan with elements"
    )


def _formed(
    system: StratifiedSystem, columns: list[sp.Matrix], outputs: FlatOutputs
) -> ChainedForm:
    state = system.state
    rates = [_rate(outputs.along, column, state) for column in columns]
    still = [_vanishes(rate, state) for rate in rates]
    if sorted(still) != [False, True]:
        raise PlannerError(
            f"{outputs.along} is moved by {2 - sum(still)} of two fields; the first "
            "flat output is moved by one only"
        )
    drive, turn = columns[still.index(False)], columns[still.index(True)]
    rate = _equal(rates[still.index(False)], outputs.rate, state)
    ahead = drive / rate
    slope = _equal(_rate(outputs.across, ahead, state), outputs.slope, state)
    both = f"{outputs.along} and {outputs.across}"
    refusal = f"{both} are not flat outputs of a chained form"
    chain = [outputs.across, slope]
    while len(chain) < len(state) - 1:
        if not _vanishes(_rate(chain[-1], turn, state), state):
            raise PlannerError(f"{refusal}: a slope is turned too early")
        chain.append(_rate(chain[-1], ahead, state))
    turned = _rate(chain[-1], turn, state)
    if _vanishes(turned, state):
        raise PlannerError(f"{refusal}: the last slope is never turned")
    fields = {
        AHEAD: ahead - turn * (_rate(chain[-1], ahead, state) / turned),
        TURN: turn / turned,
    }
    stratum = {system.bottom: fields}
    level_sets = {system.bottom: system.level_set(system.bottom).functions}
    bottom = StratifiedSystem(state, stratum, system.bottom, level_sets)
    return ChainedForm(bottom, (outputs.along, *reversed(chain)))


def _rate(function: sp.Expr, field: sp.Matrix, state: Symbols) -> sp.Expr:
    """Rate of a function along a field.

    Parts that occur several times are differentiated once: slopes of slopes are huge
    when written out, and sympy's own derivative goes through them again at every level.
    """
    known: dict[sp.Basic, sp.Expr] = dict(zip(state, field, strict=True))

    def rate(part: sp.Expr) -> sp.Expr:
        if part not in known:
            known[part] = _inner_rate(part, rate)
        return known[part]

    return rate(function)


def _inner_rate(part: sp.Expr, rate: Callable[[sp.Expr], sp.Expr]) -> sp.Expr:
    """Rate of an expression from the rates of its arguments, by the chain rule."""
    rates = [rate(inner) for inner in part.args]
    moving = [i for i, speed in enumerate(rates) if speed != 0]
    if not moving:
        return sp.S.Zero
    if part.is_Add:
        return sp.Add(*rates)
    if part.is_Mul:
        rests = (part.args[:i] + part.args[i + 1 :] for i in moving)
        return sp.Add(
            *(sp.Mul(rates[i], *rest) for i, rest in zip(moving, rests, strict=True))
        )
    if part.is_Pow and moving == [0]:
        base, power = part.args
        return power * base ** (power - 1) * rates[0]
    stand_ins = [sp.Dummy(real=inner.is_real) for inner in part.args]
    outer = part.func(*stand_ins)
    back = dict(zip(stand_ins, part.args, strict=True))
    return sp.Add(*(outer.diff(stand_ins[i]).xreplace(back) * rates[i] for i in moving))


def _values(expression: sp.Expr, state: Symbols) -> Array:
    """Values of an expression near zero, where they are finite."""
    points = NEARBY * sample_configurations(len(state))
    function = sp.lambdify(state, expression, modules="numpy", cse=True)
    with np.errstate(all="ignore"):
        values = np.array([function(*x) for x in points], dtype=float)
    return values[np.isfinite(values)]


def _vanishes(expression: sp.Expr, state: Symbols, size: float = 1.0) -> bool:
    values = _values(expression, state)
    return bool(np.abs(values).max(initial=0.0) <= VANISHED * size)


def _equal(derived: sp.Expr, declared: sp.Expr | None, state: Symbols) -> sp.Expr:
    """The declared expression if it equals the derived one, or else an error."""
    if declared is None:
        return derived
    size = float(np.abs(_values(derived, state)).max(initial=1.0))
    if not _vanishes(derived - declared, state, size):
        raise PlannerError(
            f"{declared} is declared for a flat output but is not the rate that "
            "the fields give; correct it or leave it out"
        )
    return declared
