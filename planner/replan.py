"""Plan again from where the last plan ended: single steps, and shots to any accuracy.

Systems that are not nilpotent miss the goal of a plan by little; planning again from
the state reached, or read from sensors, takes the rest away (Sec. 2.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import ConvergenceError, RangeError
from planner.execution import CHOICES, Execution
from planner.extended import ExtendedSystem
from planner.fields import Array
from planner.nominal import fictitious_inputs, sample
from planner.paths import line
from planner.plan import Plan, assemble, follow_path
from planner.rollout import play

NODES = 9  # of a straight step; its inputs vary with the heading alone
FINEST = 2.0**-20  # part of the way to the target below which a step is given up


@dataclass(frozen=True)
class Step:
    """One segment from a state towards a target.

    Attributes:
        plan: Flows of the segment.
        fraction: Part of the way that it goes, 1 unless the limits ask for less.
    """

    plan: Plan
    fraction: float


def plan_step(
    extended: ExtendedSystem, state: ArrayLike, target: ArrayLike, execution: Execution
) -> Step:
    """Plan one straight segment from a reached state, no farther than the limits allow.

    Args:
        extended: System to steer.
        state: Configuration reached, shape (n,).
        target: Configuration to go to, shape (n,).
        execution: How to carry it out; `finish=False` leaves the legs where they end.

    Raises:
        RangeError: Not even the start of the way keeps the limits.
    """
    try:
        return Step(_straight(extended, state, target, execution), 1.0)
    except RangeError as error:
        refusal = error
    state, target = np.asarray(state, float), np.asarray(target, float)
    best, low, high = None, 0.0, 1.0
    while high - low > max(FINEST, 1e-3 * low):
        middle = (low + high) / 2
        try:
            way = state + middle * (target - state)
            best, low = _straight(extended, state, way, execution), middle
        except RangeError as error:
            high, refusal = middle, error
    if best is None:
        raise refusal
    return Step(best, low)


def _straight(
    extended: ExtendedSystem, start: ArrayLike, goal: ArrayLike, execution: Execution
) -> Plan:
    return follow_path(extended, line(start, goal), 1, execution, NODES)


@dataclass(frozen=True)
class Steered:
    """A plan of shots, each from where the one before ended.

    Attributes:
        plan: The flows; every shot is a segment.
        distances: Distance to the goal before the first shot and after each.
        critical_step: Length of the shortest shot that did not halve its distance;
            infinite if all did.
    """

    plan: Plan
    distances: tuple[float, ...]
    critical_step: float


def steer(
    extended: ExtendedSystem,
    start: ArrayLike,
    goal: ArrayLike,
    execution: Execution,
    *,
    tolerance: float = 1e-9,
    max_shots: int = 100,
) -> Steered:
    """Shots along straight lines until the goal is met (Sec. 2.1).

    A shot must at least halve the distance to its target. One that does not was longer
    than the critical step: it is dropped and the next one aims half as far.

    Args:
        extended: System to steer.
        start: Configuration to start from, shape (n,).
        goal: Configuration to meet, shape (n,).
        execution: How to carry the shots out, in `backward` or `forward` coordinates.
        tolerance: Distance to the goal to end with, in the mixed unit of the state.
        max_shots: Number of shots after which to give up.

    Raises:
        ValueError: The execution leaves the choice of coordinates open.
        ConvergenceError: The shots do not come closer, or not within `max_shots`.
    """
    if execution.coordinates == "fewest":
        raise ValueError(
            "shots depend on the coordinates followed; choose backward or forward"
        )
    goal = np.asarray(goal, dtype=float)
    here = np.asarray(start, dtype=float)
    shots: list[tuple[Array, Array]] = []
    distances = [float(np.linalg.norm(goal - here))]
    part, critical = 1.0, np.inf
    while distances[-1] > tolerance:
        if len(shots) >= max_shots or part < FINEST:
            raise ConvergenceError(
                f"{len(shots)} shots end {distances[-1]:.3g} from the goal, beyond the "
                f"tolerance {tolerance:.3g}; allow more, or cut the path into segments"
            )
        target = here + part * (goal - here)
        inputs, coordinates, there = _shot(extended, here, target, execution)
        length = float(np.linalg.norm(target - here))
        if np.linalg.norm(target - there) > length / 2:
            critical, part = min(critical, length), part / 2
            continue
        here, part = there, min(1.0, 2 * part)
        shots.append((inputs, coordinates))
        distances.append(float(np.linalg.norm(goal - here)))
    return Steered(
        _assembled(extended, shots, (np.asarray(start, float), goal), execution),
        tuple(distances),
        float(critical),
    )


def _shot(
    extended: ExtendedSystem, here: Array, target: Array, execution: Execution
) -> tuple[Array, Array, Array]:
    """Inputs and Hall coordinates of one shot, and where it ends."""
    samples = sample(line(here, target), extended.system, 1, NODES)
    inputs = fictitious_inputs(extended, samples)
    coordinates = extended.steering.hall_coordinates(inputs)
    ((order,),) = CHOICES[execution.coordinates]
    (word,) = extended.steering.words(coordinates, order)
    flows = extended.grouper.flows(word, range(len(word)))
    return inputs, coordinates, play(extended.system, flows, here)[-1]


def _assembled(
    extended: ExtendedSystem,
    shots: list[tuple[Array, Array]],
    ends: tuple[Array, Array],
    execution: Execution,
) -> Plan:
    if not shots:
        return follow_path(extended, line(*ends), 1, execution, NODES)
    inputs, coordinates = (np.concatenate(parts) for parts in zip(*shots, strict=True))
    return assemble(extended, inputs, coordinates, ends, execution)
