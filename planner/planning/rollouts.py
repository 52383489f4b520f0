"""Rollout of plans by exact flows of the fields, composed as in eq. (12).

Plans leave out the flows that lift feet and set them down, since these cancel, eqs.
(13) and (14). All six flows of eq. (12) are drawn by `sim.figures.sequence`.

Many flows are integrated at once where coordinates fall into levels: rates of the first
depend on nothing, those of the next on the first, and so on. A level of its own is a
coordinate that drives itself as the heading of a trailer does, theta' = c + a cos theta
+ b sin theta, where c, a and b depend on the car alone. Half the angle is then the
direction of a point (u, v) of a linear system, u' = -b/2 u + (a - c)/2 v and
v' = (a + c)/2 u + b/2 v, whose matrices do not depend on where flows start.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
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
    follow_all,
)
from planner.planning.algorithm import Plan
from planner.systems.fields import NumericField
from planner.systems.flows import Flow, flow_map, require_flows
from planner.systems.rounding import vanishing
from planner.systems.strata import StratifiedSystem

BLOCK = 2000  # flows at once; each takes some kilobytes


def rollout(plan: Plan, samples: int = 1) -> Array:
    """States along a plan, shape (1 + samples * flows, n).

    After the start there are `samples` for each flow, the last of them at its end.

    Example:
        >>> from planner import EXAMPLES, line, plan, rollout
        >>> rollout(plan(EXAMPLES["heisenberg"], line((0, 0, 0), (0, 0, 1)), 1))[-1]
        array([0., 0., 1.])
    """
    return play(plan.system, plan.flows, plan.start, samples)


def play(
    system: StratifiedSystem, flows: Sequence[Flow], start: Array, samples: int = 1
) -> Array:
    """States along flows in time order, from a configuration (n,), as by `rollout`.

    Raises:
        ValueError: A flow names a field that its stratum does not have, or the start
            is misshapen.
        ConvergenceError: A flow escapes to infinity.

    Example:
        >>> from planner import EXAMPLES, Flow, play
        >>> flows = Flow("0", "f", 1), Flow("0", "g", 1)
        >>> play(EXAMPLES["heisenberg"], flows, (0, 0, 0))[-1]
        array([1., 1., 1.])
    """
    if samples < 1:
        raise ValueError(f"samples is {samples}; at least 1 is needed")
    require_flows(system, flows)
    states, needed = [np.asarray(start, dtype=float)], system.dimension
    if (shape := states[0].shape) != (needed,):
        raise ValueError(f"start has shape {shape}; {needed} coordinates are needed")
    shares = np.arange(1, samples) / samples
    parts = [f._replace(duration=f.duration / samples) for f in flows]
    parts = [part for part in parts for _ in range(samples)]
    worth = len(parts) >= 8  # flows, to be integrated at once
    if worth and (together := batched(system, parts, states[0])) is not None:
        return np.concatenate([states, together])
    for flow in flows:
        here, velocity = states[-1], system.compiled(flow.field).velocity
        if samples > 1:
            begins = np.tile(here, (samples - 1, 1))
            states.extend(follow_all(velocity, begins, shares * flow.duration))
        states.append(flow_map(system, flow.field, here, flow.duration))
    return np.array(states)


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
    reads = [
        {index[s] for field in fields for s in field[i].free_symbols}
        for i in range(system.dimension)
    ]
    known, order = set[int](), list[Level]()
    while rest := [i for i in range(system.dimension) if i not in known]:
        level = Level([i for i in rest if reads[i] <= known])
        if not level.coordinates:
            own = (i for i in rest if reads[i] <= known | {i})
            angular = next((i for i in own if _turns(fields, i, system)), None)
            if angular is None:
                return None
            level = Level([angular], angular=True)
        order.append(level)
        known |= set(level.coordinates)
    return order


def batched(
    system: StratifiedSystem, flows: Sequence[Flow], start: Array
) -> Array | None:
    """States after each of a sequence of flows, shape (flows, n).

    None if coordinates have no order, or a flow is too long for its polynomials.
    """
    order = levels(system, tuple(sorted({flow.field for flow in flows})))
    if order is None:
        return None
    found, here = [np.empty((0, start.size))], start
    for begin in range(0, len(flows), BLOCK):
        for nodes in (10, STEP_NODES):  # few suffice in a plan of many segments
            batch = _Batch(system, flows[begin : begin + BLOCK], nodes)
            with np.errstate(all="ignore"):
                suffice = all(batch.advance(level, here) for level in order)
            ends = batch.states[:, -1].T
            if suffice and np.isfinite(ends).all():
                break
        else:
            return None
        found.append(ends)
        here = ends[-1]
    return np.concatenate(found)


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

            def rates_at(angle: float) -> Array:
                self.states[chosen] = angle
                return self._rates(chosen)[0]

            turned = _angular_ways(rates_at, begins[0], self.durations, self.rule)
            if turned is not None:
                self._place(chosen, turned[None], begins)
            return turned is not None
        if not any(i in chosen for field, _ in self.fields for i, _ in field.varying):
            steady = self._steady(chosen)[:, None] * self.durations
            self._place(chosen, self.rule.nodes[:, None] * steady, begins)
            return True
        rates = self._rates(chosen) * self.durations
        self._place(chosen, self.rule.integral @ rates, begins)
        tail = _largest(self.rule.coefficients[-2:] @ rates)
        scale = 1.0 + np.abs(self.states[chosen, -1]).max()
        return bool(tail <= 10 * PICARD_TOLERANCE * scale < np.inf)

    def _place(self, chosen: list[int], ways: Array, start: Array) -> None:
        """Let every flow begin where the one before it ends."""
        ends = start[:, None] + np.cumsum(ways[:, -1], axis=1)
        self.states[chosen] = np.hstack([start[:, None], ends[:, :-1]])[:, None] + ways

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


def _turns(fields: Sequence[sp.Matrix], index: int, system: StratifiedSystem) -> bool:
    """Whether all rates of a coordinate are of the form c + a cos + b sin of it."""
    angle, rates = system.state[index], [field[index] for field in fields]
    zeros = [sp.Matrix([r.diff(angle, 3) + r.diff(angle)]) for r in rates]
    return all(vanishing(zeros, system.state))


def _angular_ways(
    rate: Callable[[float], Array], start: float, durations: Array, rule: Collocation
) -> Array | None:
    """How far a coordinate has come at each node of each flow, shape (nodes, flows).

    `rate` gives the rates there for a value of it. None if a flow is too long.
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
    """Directions in which flows begin in turn, from rows of matrices, (2, flows)."""
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
    """Both coordinates, (2, nodes, flows), of points that start at (1, 0) and (0, 1).

    Entries of the linear system have shape (nodes, flows), the upper left one that of
    the lower right with the other sign. None if the nodes do not suffice.
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
