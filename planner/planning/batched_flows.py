"""Many flows at once, on systems whose coordinates can be integrated one after another.

If no rate depends on a coordinate that it moves itself, directly or by way of others,
coordinates fall into levels: rates of the first depend on nothing, those of the next on
the first, and so on. Then a whole sequence of flows is integrated level by level: all
rates are known along all flows at once, and starts are sums of what came before.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.numerics.arrays import Array
from planner.numerics.collocation import NODES, TOLERANCE, collocation
from planner.systems.fields import NumericField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

BLOCK = 2000  # flows at once; each takes some kilobytes


def levels(system: StratifiedSystem, names: Sequence[str]) -> list[list[int]] | None:
    """Coordinates in the order in which flows of some fields can be integrated.

    Args:
        system: System that has the fields.
        names: Their names.

    Returns:
        Lists of indices; None if there is no such order, or it cannot be read off.
    """
    fields = [system.fields[name] for name in names]
    if any(isinstance(field, NumericField) for field in fields):
        return None
    index = {symbol: i for i, symbol in enumerate(system.state)}
    reads = [
        {index[s] for field in fields for s in field[i].free_symbols}
        for i in range(system.dimension)
    ]
    known, order = set[int](), list[list[int]]()
    while len(known) < system.dimension:
        ready = [i for i, read in enumerate(reads) if i not in known and read <= known]
        if not ready:
            return None
        order.append(ready)
        known |= set(ready)
    return order


def batched(
    system: StratifiedSystem, flows: Sequence[Flow], start: Array
) -> Array | None:
    """States after each of a sequence of flows, shape (flows, n).

    Args:
        system: System that the flows are of.
        flows: Flows in time order.
        start: Configuration before the first flow, shape (n,).

    Returns:
        The states; None if coordinates cannot be integrated one after another, or a
        flow is too long for its polynomials.
    """
    order = levels(system, list(dict.fromkeys(flow.field for flow in flows)))
    if order is None:
        return None
    found, here = [np.empty((0, start.size))], start
    for begin in range(0, len(flows), BLOCK):
        states = _block(system, flows[begin : begin + BLOCK], here, order)
        if states is None:
            return None
        found.append(states)
        here = states[-1]
    return np.concatenate(found)


def _block(
    system: StratifiedSystem,
    flows: Sequence[Flow],
    start: Array,
    order: list[list[int]],
) -> Array | None:
    rule = collocation(NODES)
    durations = np.array([flow.duration for flow in flows])[:, None, None]
    names = np.array([flow.field for flow in flows], dtype=object)
    rows = {name: np.flatnonzero(names == name) for name in dict.fromkeys(names)}
    states = np.tile(start, (len(flows), NODES, 1))
    for level in order:
        rates = np.empty((len(flows), NODES, len(level)))
        for name, on in rows.items():
            field = system.compiled(name)
            if any(i in level for i, _ in field.varying):
                rates[on] = field.velocity(states[on])[..., level]
            else:
                rates[on] = field.constant[level, 0]
        tails = np.abs(rule.coefficients[-2:] @ rates) * np.abs(durations)
        ways = durations * (rule.integral @ rates)
        ends = start[level] + np.cumsum(ways[:, -1], axis=0)
        scale = 1.0 + np.abs(ends).max()
        if not tails.max() <= 10 * TOLERANCE * scale < np.inf:
            return None
        begins = np.concatenate([start[level][None], ends[:-1]])
        states[..., level] = begins[:, None] + ways
    return states[:, -1]
