"""Systems with two fields that have a chained form, steered exactly in a single plan.

A car with trailers is not nilpotent and its critical step is minute. But its fields can
be combined to others, with factors that depend on the configuration, whose brackets
beyond one degree vanish. In suitable coordinates z these are the chained form

    z1' = u1,  z2' = u2,  z3' = z2 u1,  ...,  zn' = z(n-1) u1,

and words of that degree are exact. The coordinates follow from two functions of the
configuration, the flat outputs: z1 moves along one field only, and every other z is the
slope of the next against z1. A vehicle in the plane has such a form for every direction
that z1 may be measured in, and passes from one to the next where it turns far.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, chain, permutations

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from sympy.simplify.fu import fu

from planner.errors import PlannerError, message
from planner.extension.extended import ExtendedSystem, extend
from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan, plan, plan_of_flows
from planner.planning.paths import line
from planner.planning.plane import Plane
from planner.planning.rates import declared_or_derived, rate_along, vanishes
from planner.planning.rollouts import play
from planner.systems.fields import CompiledFields, NumericField, compile_fields
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

AHEAD, TURN = "ahead", "turn"  # the combined fields
MET = 1e-9  # distance from the goal to which flows of a chained form are followed
CORRECTED = 1e-11  # distance above which they are corrected
CORRECTABLE = 1e-2  # likewise, below which it is tried
CHART = 1.0  # [rad] to either side of its direction, for which a chart serves


@dataclass(frozen=True)
class FlatOutputs:
    """Two functions of the configuration from which a chained form follows.

    The rate of `along` per unit of the field that moves it, and the slope of `across`
    against `along`, are derived and simplified if None.
    """

    along: sp.Expr  # z1, which one of the two fields leaves alone
    across: sp.Expr  # zn
    rate: sp.Expr | None = None
    slope: sp.Expr | None = None

    def of(self, state: tuple[sp.Symbol, ...]) -> "FlatOutputs":
        """The same functions of the coordinates of these names, whatever is assumed."""
        named = {symbol.name: symbol for symbol in state}

        def own(f: sp.Expr | None) -> sp.Expr | None:
            return f and f.xreplace({s: named.get(s.name, s) for s in f.free_symbols})

        along, across = sp.sympify(self.along), sp.sympify(self.across)
        return FlatOutputs(own(along), own(across), own(self.rate), own(self.slope))


@dataclass(frozen=True, eq=False)
class ChainedForm:
    """A system in chained form."""

    system: StratifiedSystem  # of the combined fields `ahead` and `turn`, g1 and g2
    coordinates: tuple[sp.Expr, ...]  # z1, ..., zn as expressions in the state
    plane: Plane | None = None  # motions of the plane, if they change nothing

    @cached_property
    def model(self) -> ExtendedSystem:
        """The chained form itself, with the state z and the elements to steer it by."""
        z = sp.symbols(f"z1:{len(self.coordinates) + 1}")
        fields = {AHEAD: [1, 0, *z[1:-1]], TURN: [0, 1, *[0] * (len(z) - 2)]}
        brackets = accumulate(z[2:], lambda b, _: f"[{AHEAD},{b}]", initial=TURN)
        bottom = self.system.bottom
        return extend(StratifiedSystem(z, {bottom: fields}, bottom), [AHEAD, *brackets])

    @cached_property
    def _functions(self) -> CompiledFields:
        return compile_fields([sp.Matrix(self.coordinates)], self.system.state)

    def at(self, x: ArrayLike) -> Array:
        """Coordinates z of a configuration, both of shape (n,)."""
        state = np.asarray(x, dtype=float)
        z = self._functions.velocity(state)
        if not np.isfinite(z).all():
            raise PlannerError(message("chained_singular", place=self._named(state)))
        return z

    def plan(self, start: ArrayLike, goal: ArrayLike, segments: int = 1) -> Plan:
        """Flows of the combined fields from one configuration (n,) exactly to another.

        The segments divide the straight line between them in z, on which the form must
        not be singular. A vehicle in the plane that turns farther than one chart serves
        passes through several, with as many segments in each.
        """
        ends = line(start, goal)
        start, goal = ends(0.0), ends(1.0)
        if self.plane is None or self._holds(start) and self._holds(goal):
            found = self._planned(start, goal, segments)
        else:
            found = self._turning(self.plane, start, goal, segments)
        return replace(found, nominal=np.array([*found.nominal[:-1], goal]))

    def _holds(self, x: Array) -> bool:
        """Whether the chart itself serves at a configuration of a vehicle."""
        plane = self.plane
        return plane is None or (
            not plane.way_in(x)[0] and abs(plane.direction(x)) <= CHART
        )

    def _planned(self, start: Array, goal: Array, segments: int = 1) -> Plan:
        """The plan in this chart, in shorter segments where words swing too far."""
        for times in (1, 4, 16):  # as many segments
            try:
                return self._corrected(start, goal, times * segments)
            except PlannerError as error:
                refusal = error
        raise refusal

    def _corrected(self, start: Array, goal: Array, segments: int) -> Plan:
        """The plan in so many segments; what integration misses is made up for."""
        parts = [self._straight(start, goal, segments)]
        missed = [_apart(parts[-1], goal)]
        while CORRECTED < missed[-1] < CORRECTABLE and len(missed) <= 3:
            further = self._straight(parts[-1].nominal[-1], goal)
            missed.append(_apart(further, goal))
            if missed[-1] >= missed[-2]:
                break
            parts.append(further)
        if not _apart(parts[-1], goal) <= MET:
            raise self._separated(start, goal)
        flows = chain.from_iterable(part.segments() for part in parts)
        return _plan_of(self.system, [*flows], start) if parts[1:] else parts[0]

    def _turning(self, plane: Plane, start: Array, goal: Array, segments: int) -> Plan:
        """The plan of a vehicle through charts that turn along with it."""
        leave, begin = plane.way_in(start)
        enter, end = plane.way_in(goal)
        first, last = plane.direction(begin), plane.direction(end)
        count = max(1, math.ceil(abs(last - first) / CHART))
        shares = np.linspace(0.0, 1.0, count + 1)
        heading = first + (last - first) * shares
        places = line(plane.at(begin), plane.at(end)).at(shares)
        fields = dict(plane.system.fields)
        parts, here = [leave] if leave else [], begin
        for k in range(count):
            angle = float(heading[k : k + 2].mean())
            chart = ChainedForm(*plane.chart(self.system, self.coordinates, angle))
            there = end
            if k < count - 1:
                there = plane.aligned(places[k + 1], float(heading[k + 1]))
            found = chart._planned(here, there, segments)
            here = found.nominal[-1]
            numbered = {name: f"{name}_{k + 1}" for name in chart.system.fields}
            fields |= {numbered[name]: f for name, f in chart.system.fields.items()}
            for part in found.segments():
                parts.append([f._replace(field=numbered[f.field]) for f in part])
        if enter:
            parts.append([f._replace(duration=-f.duration) for f in reversed(enter)])
        system = replace(self.system, strata={self.system.bottom: fields})
        whole = _plan_of(system, parts, start)
        if not _apart(whole, goal) <= MET:
            raise self._separated(start, goal)
        return whole

    def _straight(self, start: Array, goal: Array, segments: int = 1) -> Plan:
        """The plan along the straight line in z; it ends near its goal."""
        way, nominal = line(self.at(start), self.at(goal)), [start]
        try:
            planned = plan(self.model, way, segments)
            for flows in planned.segments():
                nominal.append(play(self.system, flows, nominal[-1])[-1])
        except PlannerError as error:  # which speaks of z
            raise self._separated(start, goal) from error
        return replace(planned, system=self.system, nominal=np.array(nominal))

    def _separated(self, start: Array, goal: Array) -> PlannerError:
        ends = {"start": self._named(start), "goal": self._named(goal)}
        return PlannerError(message("separated", **ends))

    def _named(self, x: Array) -> str:
        """A configuration by the names of its coordinates."""
        values = zip(self.system.state, x.tolist(), strict=True)
        return ", ".join(f"{name} = {value:.6g}" for name, value in values)


def _apart(plan: Plan, goal: Array) -> float:
    """Distance of a plan's end from its goal."""
    return float(np.abs(plan.nominal[-1] - goal).max())


def _plan_of(
    system: StratifiedSystem, parts: Sequence[Sequence[Flow]], start: Array
) -> Plan:
    """A plan of given flows in segments, whose elements are the fields."""
    names = tuple(dict.fromkeys(flow.field for flow in chain(*parts)))
    ends = accumulate(parts, lambda x, part: play(system, part, x)[-1], initial=start)
    return plan_of_flows(system, names, parts, np.array([*ends]))


def chained_form(
    system: StratifiedSystem, outputs: FlatOutputs | None = None
) -> ChainedForm:
    """The chained form of a system with one stratum and two fields.

    Pairs of coordinates are tried if no flat outputs are given.
    """
    fields = list(system.fields.values())
    if len(fields) != 2 or any(isinstance(f, NumericField) for f in fields):
        raise PlannerError(message("two_fields", count=len(fields)))
    columns = [sp.Matrix(field) for field in fields]
    if outputs is not None:
        return _formed(system, columns, outputs.of(system.state))
    for along, across in permutations(system.state, 2):
        with suppress(PlannerError):
            return _formed(system, columns, FlatOutputs(along, across))
    raise PlannerError(message("no_outputs"))


def _formed(
    system: StratifiedSystem, columns: list[sp.Matrix], outputs: FlatOutputs
) -> ChainedForm:
    state = system.state
    rates = [rate_along(outputs.along, column, state) for column in columns]
    still = [vanishes(rate, state) for rate in rates]
    if sorted(still) != [False, True]:
        count = 2 - sum(still)
        raise PlannerError(message("not_one", along=outputs.along, count=count))
    drive, turn = columns[still.index(False)], columns[still.index(True)]
    rate = declared_or_derived(fu(rates[still.index(False)]), outputs.rate, state)
    ahead = drive / rate
    slope = fu(rate_along(outputs.across, drive, state)) / rate
    slope = declared_or_derived(slope, outputs.slope, state)
    both = f"{outputs.along} and {outputs.across}"
    refusal = f"{both} are not flat outputs of a chained form"
    slopes, names = [outputs.across, slope], list(system.fields)
    while len(slopes) < len(state) - 1:
        if not vanishes(rate_along(slopes[-1], turn, state), state):
            facts = {"name": names[still.index(True)], "order": len(slopes) - 1}
            last = len(state) - 2
            raise PlannerError(message("slopes", refusal=refusal, last=last, **facts))
        slopes.append(rate_along(slopes[-1], ahead, state))
    turned = rate_along(slopes[-1], turn, state)
    if vanishes(turned, state):
        raise PlannerError(f"{refusal}: no field changes the last slope")
    fields = {
        AHEAD: ahead - turn * (rate_along(slopes[-1], ahead, state) / turned),
        TURN: turn / turned,
    }
    order = names[still.index(False)], names[still.index(True)]
    plane = Plane.of(system, (outputs.along, outputs.across), *order)
    combined = replace(system, strata={system.bottom: fields})
    return ChainedForm(combined, (outputs.along, *reversed(slopes)), plane)
