"""Reposition all legs before every stroke, so that each is centred on zero.

If feet stay where they are while several fields flow, the motion is holonomic: when the
legs return, so does the body, and a commutator of such fields moves the body by slip
only. Therefore all legs are repositioned between strokes along different fields, and
between the parts of a stroke that is too long: legs that take part in the next stroke
go to where it will be centred on zero, the others to zero. The recoveries of the plan
itself are dropped. Meanwhile the body stands still, and legs lift in an order in which
the robot remains statically stable.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil

import numpy as np

from planner.errors import StratumError, message
from planner.execution.centring import SHORTEST_RECOVERY
from planner.numerics.arrays import Array
from planner.systems.flows import Flow, merged
from planner.systems.shape import ShapeCoordinates, ShapeLimits

LIFT_COST = 1.0  # of lifting a leg, in the unit of distances between places
STROKE_ROUNDING = 1e-9  # of a stroke that just fits its range
MOST_PARTS = 32  # of a stroke; a robot that can reposition its legs needs fewer

StabilityTest = Callable[[Sequence[str], Mapping[str, Array]], Array]
"""Whether a robot is statically stable on each of S strata.

It maps the names of the strata, and places of the shape coordinates by name, shape
(P_i,), to truth values for all combinations of places, shape (S, P_1, P_2, ...)."""


def stepped(
    shape: ShapeCoordinates,
    segments: Sequence[Sequence[Flow]],
    start: Array,
    goal: Array | None,
    limits: ShapeLimits,
    static_stability: StabilityTest | None,
) -> list[list[Flow]]:
    """The strokes of each segment, with every leg repositioned before each.

    They lead from a configuration (n,) to the shape of another, or leave the legs where
    they are if that is None. A stroke that would leave the limits is divided into
    parts. The robot is always statically stable if there is no test.
    """
    legs = _Legs(shape, start, limits, static_stability)
    ordered: list[list[Flow]] = []
    for flows in segments:
        loaded = merged(flow for flow in flows if flow.field not in shape.recoveries)
        steps = [step for flow in loaded for step in legs.stroke(flow)]
        ordered.append(list(merged(steps)))
    if goal is not None and ordered:
        ordered[-1] += legs.set({i: float(goal[i]) for i in legs.recoveries})
    return ordered


class _Legs:
    """The shape coordinates as they are now, and their recoveries."""

    def __init__(
        self,
        shape: ShapeCoordinates,
        start: Array,
        limits: ShapeLimits,
        static_stability: StabilityTest | None,
    ) -> None:
        self.shape, self.static_stability = shape, static_stability
        self.now = np.array(start, dtype=float)
        self.recoveries: dict[int, tuple[Flow, float]] = {}  # unit of time, and rate
        for name, (i, rate) in shape.recoveries.items():
            unit = Flow(shape.system.stratum_of[name], name, 1.0)
            self.recoveries.setdefault(i, (unit, rate))
        self.spans = {shape.names.index(name): span for name, span in limits.items()}

    def stroke(self, flow: Flow) -> Iterator[Flow]:
        """A stroke in parts, with the legs repositioned before each part."""
        rates = np.nan_to_num(self.shape.rates[flow.field])
        for i, (low, high) in self.spans.items():
            if rates[i] and i not in self.recoveries:
                name = self.shape.names[i]
                raise StratumError(message("no_recovery", field=flow.field, name=name))
            if rates[i] and not low < 0 < high:
                facts = {"name": self.shape.names[i], "low": low, "high": high}
                raise StratumError(message("around_zero", field=flow.field, **facts))
        parts = self._parts(flow.duration * rates)
        part = flow._replace(duration=flow.duration / parts)
        for _ in range(parts):
            ahead = {i: -part.duration * rates[i] / 2 for i in self.recoveries}
            yield from self.set(ahead)
            yield part
            self.now += part.duration * rates

    def _parts(self, way: Array) -> int:
        """Number of parts of a stroke that range and stability ask for.

        Legs that can be moved from zero to the ends of a stroke can also be moved back,
        and so from the end of any stroke to the start of any other.
        """
        spans = [(i, 2 * min(high, -low)) for i, (low, high) in self.spans.items()]
        shares = [abs(way[i]) / span for i, span in spans if way[i]]
        fewest = max(1, ceil(max(shares, default=0.0) - STROKE_ROUNDING))
        rest = dict.fromkeys(self.recoveries, 0.0)
        for parts in range(fewest, fewest + MOST_PARTS):
            ends = ({i: side * way[i] / parts for i in rest} for side in (-0.5, 0.5))
            if all(self._moves(rest, end) is not None for end in ends):
                return parts
        raise StratumError(message("tips"))

    def set(self, targets: Mapping[int, float]) -> list[Flow]:
        """Bring coordinates to their targets by recoveries in a stable order."""
        now = {i: float(self.now[i]) for i in targets}
        moves = self._moves(now, targets)
        if moves is None:
            where = ", ".join(f"{self.shape.names[i]} = {now[i]:.4g}" for i in now)
            raise StratumError(message("all_tip", place=where))
        flows: list[Flow] = []
        for i, place in moves:
            unit, rate = self.recoveries[i]
            flows.append(unit._replace(duration=(place - self.now[i]) / rate))
            self.now[i] = place
        return flows

    def _moves(
        self, now: Mapping[int, float], targets: Mapping[int, float]
    ) -> list[tuple[int, float]] | None:
        """The cheapest moves, by way of zero and the ends of the range if need be."""
        legs = sorted(targets)
        if self.static_stability is None:
            return [(i, targets[i]) for i in legs if _apart(now[i], targets[i])]
        places = []
        for i in legs:  # where it is, its target, zero, and the ends of its range
            kept = [now[i]]
            for place in (targets[i], 0.0, *self.spans.get(i, ())):
                if all(_apart(place, other) for other in kept):
                    kept.append(place)
            places.append(np.array(kept))
        named = dict(zip((self.shape.names[i] for i in legs), places, strict=True))
        strata = [self.recoveries[i][0].stratum for i in legs]
        steady = self.static_stability(strata, named)
        goal = [int(_apart(now[i], targets[i])) for i in legs]
        moves = reposition_legs(places, steady, [0] * len(legs), goal)
        return moves and [(legs[leg], place) for leg, place in moves]


def _apart(one: float, other: float) -> bool:
    return abs(one - other) > SHORTEST_RECOVERY


def reposition_legs(
    places: Sequence[Array], steady: Array, now: Sequence[int], goal: Sequence[int]
) -> list[tuple[int, float]] | None:
    """The cheapest sequence of moves through the air, one leg at a time.

    Whether the robot is statically stable without a leg depends on where the others
    are, so that a leg may have to wait, or to stand elsewhere for a while.

    Each of L legs has places (P_i,) where it may stand, with the index of the place
    where it is, and where it is to be. `steady`, shape (L, P_1, ..., P_L), bool, is
    whether the robot is stable while a leg is in the air. Gives leg and place of each
    move in time order, or None if value iteration finds no sequence that leads there.
    """
    ways = [LIFT_COST + np.abs(place[:, None] - place) for place in places]
    for way in ways:
        np.fill_diagonal(way, np.inf)  # to stay
    cost = np.full([len(place) for place in places], np.inf)
    cost[tuple(goal)] = 0.0
    nearer = _nearer(cost, ways, steady)
    while (nearer < cost).any():
        cost, nearer = nearer, _nearer(nearer, ways, steady)
    here, moves = list(now), list[tuple[int, float]]()
    if not np.isfinite(cost[tuple(here)]):
        return None
    while here != list(goal):
        found = []  # next moves: what is left to pay, leg and place
        for leg, (way, free) in enumerate(zip(ways, steady, strict=True)):
            if free[tuple(here)]:
                line: tuple[int | slice, ...]
                line = (*here[:leg], slice(None), *here[leg + 1 :])
                onward = way[here[leg]] + np.where(free, cost, np.inf)[line]
                found.append((float(onward.min()), leg, int(onward.argmin())))
        leg, place = min(found)[1:]
        here[leg] = place
        moves.append((leg, float(places[leg][place])))
    return moves


def _nearer(cost: Array, ways: Sequence[Array], steady: Array) -> Array:
    """Cost of reaching the goal with at most one more move than before."""
    best = cost
    for leg, (way, free) in enumerate(zip(ways, steady, strict=True)):
        landed = np.where(free, cost, np.inf).swapaxes(leg, 0)  # (P, ...)
        across = way.reshape(*way.shape, *[1] * (cost.ndim - 1)) + landed
        onward = across.min(axis=1).swapaxes(leg, 0)
        best = np.minimum(best, np.where(free, onward, np.inf))
    return best
