"""Plans between configurations in which feet are lifted at either end (Sec. 5).

A plan runs on the bottom stratum. Feet that are in the air at the start therefore touch
down before the plan begins, and feet that are to be in the air at the goal lift off
after it has ended. The plan in between is made in the usual way.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import StratumError, message, point
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan, plan
from planner.planning.paths import line
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

ON_GROUND = 1e-9  # of a level set, in its unit


def stratum_at(system: StratifiedSystem, x: ArrayLike) -> str:
    """The stratum of a configuration (n,), with as many contacts as it has."""
    state = np.asarray(x, dtype=float)

    def off(stratum: str) -> float:
        level_set = system.level_set(stratum)
        free = not level_set.functions
        return 0.0 if free else float(np.abs(level_set.value(state)).max())

    on = [stratum for stratum in system.strata if off(stratum) <= ON_GROUND]
    if not on:
        raise StratumError(f"{point(state)} lies on no stratum; put its feet down")
    return max(on, key=lambda stratum: len(system.contacts[stratum]))


def set_down(system: StratifiedSystem, x: ArrayLike) -> Array:
    """The configuration (n,) with every foot set down; level sets are heights."""
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
    """A plan along the straight line between configurations with some feet lifted.

    The strata before and after the execution are those of the ends, shape (n,).
    """
    system = extended.system
    way = line(start, goal)
    ends = way(0.0), way(1.0)
    depart, arrive = (stratum_at(system, x) for x in ends)
    down = [set_down(system, x) for x in ends]
    execution = replace(execution or Execution(), depart=depart, arrive=arrive)
    planned = plan(extended, line(*down), segments, execution=execution)
    shape, (below, above) = extended.shape, (_lifted(system, x).items() for x in ends)
    landing = [_lift(shape, depart, place, -height) for place, height in below]
    lifting = [_lift(shape, arrive, place, height) for place, height in above]
    return _joined(planned, landing, lifting, ends)


def _lifted(system: StratifiedSystem, x: Array) -> dict[int, float]:
    """Heights above the bottom stratum by coordinate."""
    heights = {}
    for function in system.level_set(system.bottom).functions:
        if function not in system.state:
            raise StratumError(message("no_height", function=function))
        place = system.state.index(function)
        if x[place] < -ON_GROUND:
            raise StratumError(message("below", function=function, height=x[place]))
        if x[place] > ON_GROUND:
            heights[place] = float(x[place])
    return heights


def _lift(shape: ShapeCoordinates, stratum: str, place: int, height: float) -> Flow:
    """The flow of a stratum that changes one coordinate by a height."""
    for name in shape.system.strata[stratum]:
        rates = shape.rates[name]
        if np.isfinite(rates).all() and np.flatnonzero(rates).tolist() == [place]:
            return Flow(stratum, name, height / float(rates[place]))
    raise StratumError(message("no_lift", stratum=stratum, name=shape.names[place]))


def _joined(
    planned: Plan, landing: list[Flow], lifting: list[Flow], ends: Sequence[Array]
) -> Plan:
    """The plan with feet set down after its first stay and raised before its last."""
    flows = list(planned.flows)
    first = _stay(flows, planned.depart)
    last = max(first, len(flows) - _stay(flows[::-1], planned.arrive))
    flows = [*flows[:first], *landing, *flows[first:last], *lifting, *flows[last:]]
    shifted = [
        end + len(landing) * (end >= first) + len(lifting) * (end > last)
        for end in planned.segment_ends[:-1]
    ]
    nominal = planned.nominal.copy()
    nominal[0], nominal[-1] = ends
    ends_at = (*shifted, len(flows))
    return replace(planned, flows=tuple(flows), segment_ends=ends_at, nominal=nominal)


def _stay(flows: Sequence[Flow], stratum: str) -> int:
    """How many flows come first on a stratum."""
    return len(list(takewhile(lambda flow: flow.stratum == stratum, flows)))
