"""The critical step: how far a single plan may reach and still converge when repeated.

A plan that at least halves the distance to its target converges to it when it is
repeated from where it ended (Sec. 2.1, and the critical algorithm of the paper's
reference [3]). How long such a step may be is estimated here before anything is
planned.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import BudgetError, PlannerError
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.nominal import extend_along
from planner.planning.paths import line
from planner.planning.shooting import shot_towards
from planner.systems.strata import StratifiedSystem

DOUBLINGS = 20  # from the given step, or from one of length 1, to infinite ones
HALVINGS = 40  # to one that counts as none
ACCURACY = 1e-3  # relative, of the step


def critical_step(
    system: StratifiedSystem | ExtendedSystem,
    at: ArrayLike,
    direction: ArrayLike,
    execution: Execution | None = None,
) -> float:
    """Length of the longest straight step of which a plan leaves at most half.

    The given step is doubled or halved until one step serves and one twice as long does
    not, and the place between them is bisected. Steps beyond the first that fails may
    serve again; they are not looked for.

    Args:
        system: System to steer; compiled by `extend` beforehand where speed matters.
        at: Configuration to start from, shape (n,).
        direction: Step to begin with, shape (n,), in the direction of interest.
        execution: How to carry the steps out; in backward coordinates if not given, or
            where it leaves the choice of coordinates open.

    Returns:
        A length in the mixed unit of the state, infinite where every step serves, as
        on nilpotent systems, and 0 where none does.

    Raises:
        ValueError: The direction is zero, or something is misshapen or not finite.
    """
    if np.shape(at) != np.shape(direction):
        raise ValueError(
            f"direction of shape {np.shape(direction)} at a configuration of shape "
            f"{np.shape(at)}; give both as states"
        )
    way = line(at, np.add(at, direction))
    start, step = way(0.0), way(1.0) - way(0.0)
    if not step.any():
        raise ValueError("the direction is zero; give the step to begin with")
    if execution is None or execution.coordinates == "fewest":
        execution = replace(execution or Execution(), coordinates="backward")
    extended = extend_along(system, None, way)
    factor = _longest(extended, start, step, execution)
    return factor * float(np.linalg.norm(step))


def _longest(
    extended: ExtendedSystem, start: Array, step: Array, execution: Execution
) -> float:
    """The critical step as a multiple of the given one."""

    def serves(factor: float) -> bool:
        target = start + factor * step
        try:
            end = shot_towards(extended, start, target, execution).end
        except BudgetError:
            raise
        except PlannerError:
            return False
        return bool(np.linalg.norm(target - end) <= np.linalg.norm(factor * step) / 2)

    low, high = (1.0, 2.0) if serves(1.0) else (0.5, 1.0)
    if low == 1.0:
        unit = 1.0 / float(np.linalg.norm(step))
        while serves(high):
            low, high = high, 2 * high
            if high > 2.0**DOUBLINGS * max(1.0, unit):
                return float("inf")
    else:
        while not serves(low):
            low, high = low / 2, low
            if low < 2.0**-HALVINGS:
                return 0.0
    while high - low > ACCURACY * high:
        middle = (low + high) / 2
        low, high = (middle, high) if serves(middle) else (low, middle)
    return low
