"""Rollout of plans by exact flows of the fields, composed as in eq. (12).

Plans leave out the flows that lift feet and set them down, since these cancel, eqs.
(13) and (14). All six flows of eq. (12) are drawn by `sim.figures.sequence`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan
from planner.planning.batched_flows import batched
from planner.systems.flows import Flow, flow_map, require_flows
from planner.systems.strata import StratifiedSystem

WORTH_BATCHING = 8  # flows that are worth being integrated at once


def rollout(plan: Plan, samples: int = 1) -> Array:
    """States along a plan, from its start.

    Args:
        plan: Plan to follow.
        samples: Number of states along each flow; the last of them is its end.

    Returns:
        Shape (1 + samples * flows, n): the start, then `samples` rows for each flow.

    Example:
        >>> from planner import StratifiedSystem, line, plan, rollout
        >>> fields = {"f": [1, 0, 0], "g": [0, 1, "x"]}
        >>> system = StratifiedSystem("x y z", {"0": fields}, "0")
        >>> rollout(plan(system, line((0, 0, 0), (0, 0, 1)), 1))[-1]
        array([0., 0., 1.])
    """
    return play(plan.system, plan.flows, plan.start, samples)


def play(
    system: StratifiedSystem, flows: Sequence[Flow], start: Array, samples: int = 1
) -> Array:
    """States along a sequence of flows, as `rollout` gives them.

    Args:
        system: System that the flows are of.
        flows: Flows in time order.
        start: Configuration before the first flow, shape (n,).
        samples: Number of states along each flow; the last of them is its end.

    Raises:
        ValueError: A flow names a field that its stratum does not have, or the start
            is misshapen.
        ConvergenceError: A flow escapes to infinity.

    Example:
        >>> from planner import Flow, StratifiedSystem, play
        >>> fields = {"f": [1, 0, 0], "g": [0, 1, "x"]}
        >>> system = StratifiedSystem("x y z", {"0": fields}, "0")
        >>> play(system, [Flow("0", "f", 1), Flow("0", "g", 1)], (0, 0, 0))[-1]
        array([1., 1., 1.])
    """
    if samples < 1:
        raise ValueError(f"samples is {samples}; at least 1 is needed")
    require_flows(system, flows)
    states = [np.asarray(start, dtype=float)]
    if states[0].shape != (system.dimension,):
        raise ValueError(
            f"start has shape {states[0].shape}; {system.dimension} coordinates are "
            "needed"
        )
    parts = flows
    if samples > 1:
        parts = [
            Flow(stratum, field, duration / samples)
            for stratum, field, duration in flows
            for _ in range(samples)
        ]
    if len(parts) >= WORTH_BATCHING:
        together = batched(system, parts, states[0])
        if together is not None:
            return np.concatenate([states, together])
    for flow in parts:
        states.append(flow_map(system, flow.field, states[-1], flow.duration))
    return np.array(states)
