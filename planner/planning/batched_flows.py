"""Many flows at once, on systems whose coordinates can be integrated one after another.

If no rate depends on a coordinate that it moves itself, directly or by way of others,
coordinates fall into levels: rates of the first depend on nothing, those of the next on
the first, and so on. Then a whole sequence of flows is integrated level by level: all
rates are known along all flows at once, and starts are sums of what came before. A
level of its own is a coordinate that drives itself as the heading of a trailer does,
theta' = c + a cos theta + b sin theta, where c, a and b depend on the car alone. Half
the angle is then the direction of a point (u, v) of a linear system,
u' = -b/2 u + (a - c)/2 v and v' = (a + c)/2 u + b/2 v, whose matrices are found for all
flows at once, before it is known where each of them starts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from math import cos, hypot, pi, sin
from typing import NamedTuple

import numpy as np
import sympy as sp

from planner.numerics.arrays import Array
from planner.numerics.collocation import (
    PICARD_ITERATIONS,
    PICARD_TOLERANCE,
    STEP_NODES,
    Collocation,
    collocation,
)
from planner.systems.fields import NumericField, Symbols
from planner.systems.flows import Flow
from planner.systems.rounding import vanishing
from planner.systems.strata import StratifiedSystem

BLOCK = 2000  # flows at once; each takes some kilobytes
NODES = 10, STEP_NODES  # of a flow; few suffice in a plan of many segments


class Level(NamedTuple):
    """Indices of coordinates that are integrated together."""

    coordinates: list[int]
    angular: bool = False  # whether it is a single one whose rates depend on itself


@lru_cache(maxsize=32)
def levels(system: StratifiedSystem, names: tuple[str, ...]) -> list[Level] | None:
    """Coordinates in the order in which flows of the named fields can be integrated.

    None if there is no such order, or it cannot be read off.
    """
    fields = [system.fields[name] for name in names]
    if any(isinstance(field, NumericField) for field in fields):
        return None
    index = {symbol: i for i, symbol in enumerate(system.state)}
    rates = [[field[i] for field in fields] for i in range(system.dimension)]
    reads = [{index[s] for rate in each for s in rate.free_symbols} for each in rates]
    known, order = set[int](), list[Level]()
    while len(known) < system.dimension:
        rest = [i for i in range(system.dimension) if i not in known]
        level = Level([i for i in rest if reads[i] <= known])
        if not level.coordinates:
            own = (i for i in rest if reads[i] <= known | {i})
            angular = (i for i in own if _is_angular(rates[i], i, system.state))
            first = next(angular, None)
            if first is None:
                return None
            level = Level([first], angular=True)
        order.append(level)
        known |= set(level.coordinates)
    return order


def batched(
    system: StratifiedSystem, flows: Sequence[Flow], start: Array
) -> Array | None:
    """States after each of a sequence of flows, shape (flows, n).

    None if coordinates cannot be integrated one after another, or a flow is too long
    for its polynomials.
    """
    order = levels(system, tuple(sorted({flow.field for flow in flows})))
    if order is None:
        return None
    found, here = [np.empty((0, start.size))], start
    for begin in range(0, len(flows), BLOCK):
        block = flows[begin : begin + BLOCK]
        tried = (_states(system, block, here, order, n) for n in NODES)
        states = next((ends for ends in tried if ends is not None), None)
        if states is None:
            return None
        found.append(states)
        here = states[-1]
    return np.concatenate(found)


def _states(
    system: StratifiedSystem,
    flows: Sequence[Flow],
    start: Array,
    order: Sequence[Level],
    nodes: int,
) -> Array | None:
    """States after each flow; None if so many nodes do not suffice."""
    batch = _Batch(system, flows, nodes)
    with np.errstate(all="ignore"):
        if not all(batch.advance(level, start) for level in order):
            return None
    ends: Array = batch.states[:, -1].T
    return ends if np.isfinite(ends).all() else None


class _Batch:
    """States at the nodes of a sequence of flows, shape (n, nodes, flows)."""

    def __init__(
        self, system: StratifiedSystem, flows: Sequence[Flow], nodes: int
    ) -> None:
        self.rule = collocation(nodes)
        self.durations = np.array([flow.duration for flow in flows])
        names = np.array([flow.field for flow in flows])
        self.fields = [
            (system.compiled(name), np.flatnonzero(names == name))
            for name in dict.fromkeys(names.tolist())
        ]
        self.states = np.zeros((system.dimension, nodes, len(flows)))

    def advance(self, level: Level, start: Array) -> bool:
        """Integrate the next coordinates; whether the nodes suffice for that."""
        chosen, begins = level.coordinates, start[level.coordinates]
        if level.angular:
            at = partial(self._at, chosen[0])
            turned = _angular_ways(at, begins[0], self.durations, self.rule)
            if turned is None:
                return False
            self._place(chosen, turned[None], begins)
            return True
        if not any(i in chosen for field, _ in self.fields for i, _ in field.varying):
            steady = self._steady(chosen)[:, None] * self.durations
            self._place(chosen, self.rule.nodes[:, None] * steady, begins)
            return True
        rates = self._rates(chosen) * self.durations
        self._place(chosen, self.rule.integral @ rates, begins)
        tail = np.abs(self.rule.coefficients[-2:] @ rates).max()
        scale = 1.0 + np.abs(self.states[chosen, -1]).max()
        return bool(tail <= 10 * PICARD_TOLERANCE * scale < np.inf)

    def _place(self, chosen: list[int], ways: Array, start: Array) -> None:
        """Let every flow begin where the one before it ends."""
        ends = start[:, None] + np.cumsum(ways[:, -1], axis=1)
        begins = np.hstack([start[:, None], ends[:, :-1]])
        self.states[chosen] = begins[:, None] + ways

    def _at(self, coordinate: int, value: float) -> Array:
        """Rates of a coordinate wherever it has a value, shape (nodes, flows)."""
        self.states[coordinate] = value
        return self._rates([coordinate])[0]

    def _steady(self, chosen: list[int]) -> Array:
        """Rates of some coordinates where they are constant, (coordinates, flows)."""
        steady = np.empty((len(chosen), self.durations.size))
        for field, on in self.fields:
            steady[:, on] = field.constant[chosen]
        return steady

    def _rates(self, chosen: list[int]) -> Array:
        """Rates of some coordinates, shape (coordinates, nodes, flows)."""
        rates = np.empty((len(chosen), *self.states.shape[1:]))
        rates[...] = self._steady(chosen)[:, None]
        for field, on in self.fields:
            if any(i in chosen for i, _ in field.varying):
                values = field.function(*self.states[:, :, on])
                for (i, _), value in zip(field.varying, values, strict=True):
                    if i in chosen:
                        rates[chosen.index(i)][:, on] = value
        return rates


def _is_angular(rates: Sequence[sp.Expr], index: int, state: Symbols) -> bool:
    """Whether all rates of a coordinate are of the form c + a cos + b sin of it."""
    angle = state[index]
    return all(
        vanishing([sp.Matrix([r.diff(angle, 3) + r.diff(angle)])], state)[0]
        for r in rates
    )


def _angular_ways(
    rate: Callable[[float], Array], start: float, durations: Array, rule: Collocation
) -> Array | None:
    """How far a coordinate has come at each node of each flow, shape (nodes, flows).

    `rate` maps a value of the coordinate to its rates there at the nodes of all flows,
    likewise; durations are signed. None if a flow is too long for the nodes.
    """
    ahead, across, back = (durations * rate(angle) for angle in (0.0, pi / 2, pi))
    moved = np.flatnonzero(ahead.any(axis=0) | across.any(axis=0) | back.any(axis=0))
    ahead, across, back = ahead[:, moved], across[:, moved], back[:, moved]
    mean, along = (ahead + back) / 2, (ahead - back) / 2
    across -= mean
    if not _largest(np.abs(mean) + np.abs(along) + np.abs(across)) < pi:
        return None
    points = _points(across / 2, (along - mean) / 2, (along + mean) / 2, rule)
    if points is None:
        return None
    u, v = points
    x, y = _starts(u[:, -1], v[:, -1], start / 2)
    u, v = u[0] * x + u[1] * y, v[0] * x + v[1] * y
    ways = np.zeros((len(rule.nodes), durations.size))
    ways[:, moved] = 2 * np.arctan2(x * v - y * u, x * u + y * v)
    return ways


def _starts(u: Array, v: Array, angle: float) -> Array:
    """Directions in which flows begin one after another, shape (2, flows).

    The rows of each flow's matrix, `u` and `v`, have that shape as well.
    """
    x, y = cos(angle), sin(angle)
    starts = []
    for u_x, u_y, v_x, v_y in np.concatenate([u, v]).T.tolist():
        starts.append((x, y))
        x, y = u_x * x + u_y * y, v_x * x + v_y * y
        size = hypot(x, y)
        x, y = x / size, y / size
    return np.array(starts).reshape(-1, 2).T


def _points(
    diagonal: Array, upper: Array, lower: Array, rule: Collocation
) -> tuple[Array, Array] | None:
    """Both coordinates of the points that start at (1, 0) and at (0, 1).

    The entries of the linear system have shape (nodes, flows); its upper left one is
    the negative of the lower right. Each result has shape (2, nodes, flows); there is
    none if the nodes do not suffice.
    """
    begin = np.eye(2)[:, :, None, None]
    u, v = np.broadcast_to(begin, (2, 2, *diagonal.shape))
    for _ in range(PICARD_ITERATIONS):
        before = u, v
        rates = upper * v - diagonal * u, lower * u + diagonal * v
        u, v = (b + rule.integral @ r for b, r in zip(begin, rates, strict=True))
        if max(_largest(u - before[0]), _largest(v - before[1])) <= PICARD_TOLERANCE:
            tail = max(_largest(rule.coefficients[-2:] @ r) for r in rates)
            return (u, v) if tail <= PICARD_TOLERANCE else None
    return None


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
