"""Plans between configurations in which feet are lifted at either end (Sec. 5).

A plan runs on the bottom stratum. Feet that are in the air at the start therefore touch
down before the plan begins, and feet that are to be in the air at the goal lift off
after it has ended. The plan in between is made in the usual way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import StratumError, point
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan, plan
from planner.planning.paths import line
from planner.systems.fields import NumericField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

ON_GROUND = 1e-9  # of a level set, in its unit


def stratum_at(system: StratifiedSystem, x: ArrayLike) -> str:
    """The stratum that a configuration lies on, with as many contacts as it has.

    Args:
        system: System with level sets.
        x: Configuration, shape (n,).

    Raises:
        StratumError: It lies on none.
    """
    state = np.asarray(x, dtype=float)
    on = [s for s in system.strata if _is_on(system, s, state)]
    if not on:
        raise StratumError(f"{point(state)} lies on no stratum; put its feet down")
    return max(on, key=lambda stratum: len(system.contacts[stratum]))


def _is_on(system: StratifiedSystem, stratum: str, x: Array) -> bool:
    level_set = system.level_set(stratum)
    functions = level_set.functions
    return not functions or bool(np.abs(level_set.value(x)).max() <= ON_GROUND)


def set_down(system: StratifiedSystem, x: ArrayLike) -> Array:
    """The configuration with every foot on the ground, shape (n,).

    Args:
        system: System whose level sets are heights of feet.
        x: Configuration with some feet lifted, shape (n,).

    Raises:
        StratumError: A foot is lifted along no coordinate, or is below the ground.
    """
    down = np.array(x, dtype=float)
    down[list(_lifted(system, down))] = 0.0
    return down


def plan_between(
    extended: ExtendedSystem,
    start: ArrayLike,
    goal: ArrayLike,
    segments: int,
    execution: Execution | None = None,
) -> Plan:
    """A plan along the straight line whose ends may lie on different strata.

    Args:
        extended: System to steer.
        start: Configuration to start from, shape (n,), with some feet lifted.
        goal: Configuration to reach, likewise.
        segments: Number of pieces that the line is cut into.
        execution: How to carry the plan out; the strata at its ends are those of the
            configurations.

    Raises:
        StratumError: An end lies on no stratum, one of its feet is below the ground, or
            no field of its stratum lifts one of the feet.
        PlannerError: As for `plan`.
    """
    system = extended.system
    way = line(start, goal)
    ends = way(0.0), way(1.0)
    depart, arrive = (stratum_at(system, x) for x in ends)
    lifted = [_lifted(system, x) for x in ends]
    down = [set_down(system, x) for x in ends]
    execution = replace(execution or Execution(), depart=depart, arrive=arrive)
    planned = plan(extended, line(*down), segments, execution=execution)
    landing = _raise(system, depart, {i: -h for i, h in lifted[0].items()})
    lifting = _raise(system, arrive, lifted[1])
    return _joined(planned, landing, lifting, ends)


def _lifted(system: StratifiedSystem, x: Array) -> dict[int, float]:
    """Heights above the bottom stratum by coordinate."""
    heights = {}
    for function in system.level_set(system.bottom).functions:
        if function not in system.state:
            raise StratumError(
                f"feet are lifted along {function}, which is no coordinate of the "
                "state; start and end on the bottom stratum"
            )
        place = system.state.index(function)
        if x[place] < -ON_GROUND:
            raise StratumError(
                f"{function} is {x[place]:g}, a foot below the ground; heights are at "
                "least 0"
            )
        if x[place] > ON_GROUND:
            heights[place] = float(x[place])
    return heights


def _raise(
    system: StratifiedSystem, stratum: str, heights: dict[int, float]
) -> list[Flow]:
    """Flows of a stratum that change coordinates by given heights in turn."""
    return [
        Flow(stratum, *_lift(system, stratum, place, height))
        for place, height in heights.items()
    ]


def _lift(
    system: StratifiedSystem, stratum: str, place: int, height: float
) -> tuple[str, float]:
    for name, field in system.strata[stratum].items():
        if isinstance(field, NumericField):
            continue
        others = [entry for i, entry in enumerate(field) if i != place]
        if not any(others) and field[place].is_number and field[place] != 0:
            return name, height / float(field[place])
    raise StratumError(
        f"no field of S{stratum} moves {system.state[place]} alone; give it one that "
        "lifts this foot"
    )


def _joined(
    planned: Plan, landing: list[Flow], lifting: list[Flow], ends: Sequence[Array]
) -> Plan:
    """The plan with feet set down after its first stay and raised before its last."""
    flows = list(planned.flows)
    first = _stay(flows, planned.depart)
    last = len(flows) - _stay(flows[::-1], planned.arrive)
    last = max(first, last)
    joined = [*flows[:first], *landing, *flows[first:last], *lifting, *flows[last:]]
    shifted = [
        end + len(landing) * (end >= first) + len(lifting) * (end > last)
        for end in planned.segment_ends[:-1]
    ]
    nominal = planned.nominal.copy()
    nominal[0], nominal[-1] = ends
    return replace(
        planned,
        flows=tuple(joined),
        segment_ends=(*shifted, len(joined)),
        nominal=nominal,
    )


def _stay(flows: Sequence[Flow], stratum: str) -> int:
    """How many flows come first on a stratum."""
    return len(list(takewhile(lambda flow: flow.stratum == stratum, flows)))
