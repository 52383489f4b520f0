"""Shooting: meet goals exactly on systems that are not nilpotent (Sec. 2.1).

A shot is a plan of one straight segment together with its rollout. `steer` appends
shots, each from where the one before ended, until the goal is met. `aim` changes the
target of a single shot until it ends at the goal, so that the plan has as many flows as
an open-loop plan. `plan_step` replans one segment from a reached state, in the legs'
range.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import ConvergenceError, PlannerError, RangeError, message
from planner.execution.execution import CHOICES, Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.algorithm import Plan, assemble, follow_path, with_remedy
from planner.planning.nominal import fictitious_inputs_along, require_segments, sample
from planner.planning.paths import Path, as_path, grid, line
from planner.planning.rollouts import play
from planner.support.stopping import tick

SEGMENT_NODES = 9  # of a straight step; its inputs vary with the heading only
FINEST = 2.0**-20  # smallest part of the way to the target that a step may go
STALLED = 10  # shots that must at least halve the distance together
AIMED_PIECES = (1, 2, 4, 8)  # tried in turn where shots stall


class Shot(NamedTuple):
    """One straight segment, planned and followed."""

    start: Array  # configuration, shape (n,)
    inputs: Array  # fictitious inputs at its nodes, shape (1, nodes, p)
    hall_coordinates: Array  # backward coordinates, shape (1, s)
    end: Array  # configuration that its flows end in, shape (n,)


class Steered(NamedTuple):
    """A plan made of shots, each from where the one before ended."""

    plan: Plan  # every shot is a segment
    distances: tuple[float, ...]  # to the goal, before the first shot and after each
    critical_step: float  # shortest shot that did not halve its distance, or infinity


@dataclass(frozen=True)
class Step:
    """A plan of one segment, and the part of the way to its target that it goes."""

    plan: Plan
    fraction: float  # 1 unless the limits allow less


def aim(
    extended: ExtendedSystem,
    path: Path | Callable[[float], ArrayLike],
    segments: int,
    execution: Execution,
    *,
    tolerance: float = 1e-9,
) -> Plan:
    """A plan that meets the end of each segment, open loop.

    Straight segments replace the path, which gives configurations on the bottom stratum
    for s in [0, 1]. Their ends are missed by the tolerance at most, in the metric. The
    coordinates of the execution are not `fewest`.

    Raises:
        ValueError: The execution leaves the choice of coordinates open, or the number
            of segments is invalid.
        ConvergenceError: A segment is too long for aiming to converge.
        RangeError: The plan leaves the limits; the number of segments that it suggests
            is that of an open-loop plan.

    Example:
        >>> from planner import EXAMPLES, Execution, aim, extend, line, rollout
        >>> extended = extend(EXAMPLES["car"], ["drive", "turn", "[drive,turn]"])
        >>> sideways = line((0, 0, 0), (0, 1, 0))
        >>> found = aim(extended, sideways, 4, Execution(coordinates="backward"))
        >>> bool(abs(rollout(found)[-1] - (0, 1, 0)).max() < 1e-8)
        True
    """
    nominal = as_path(path)
    require_segments(segments, nominal)
    targets = nominal.at(grid(nominal, segments))
    shots = _aimed_along(targets, extended, execution, tolerance)
    try:
        return _assembled(extended, shots, targets, execution)
    except RangeError as error:
        raise with_remedy(error, extended, nominal, segments, execution) from None


def _aimed_along(
    targets: Array, extended: ExtendedSystem, execution: Execution, tolerance: float
) -> list[Shot]:
    """Shots from each of the configurations (segments + 1, n) to the next."""
    shots, here = list[Shot](), targets[0]
    for number, target in enumerate(targets[1:], start=1):
        shot = _aimed(extended, here, target, execution, tolerance)
        if shot is None:
            facts = {"number": number, "count": len(targets) - 1}
            raise ConvergenceError(message("aimed", tolerance=tolerance, **facts))
        shots.append(shot)
        here = shot.end
    return shots


def _aimed(
    extended: ExtendedSystem,
    here: Array,
    target: Array,
    execution: Execution,
    tolerance: float,
) -> Shot | None:
    """The shot that ends at the target, by Broyden's method on the point aimed at.

    The first approximation is that the end moves as the aim does. No correction is
    longer than the segment.
    """
    weights = extended.system.weights
    there, inverse = target, np.eye(target.size)  # of the end's change with the aim
    shot = shot_towards(extended, here, there, execution)
    miss = weights * (target - shot.end)
    longest = float(extended.system.length(target - here))
    for _ in range(40):  # a dozen suffice where aiming converges
        tick()
        if np.linalg.norm(miss) <= tolerance:
            return shot
        step = inverse @ miss
        step *= min(1.0, longest / float(np.linalg.norm(step)))
        there = there + step / weights
        shot = shot_towards(extended, here, there, execution)
        missed, miss = miss, weights * (target - shot.end)
        expected = inverse @ (missed - miss)
        if not abs(step @ expected) > 0.0:
            return None
        inverse += np.outer(step - expected, step @ inverse) / (step @ expected)
    return None


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

    A shot must at least halve the distance to its target. A shot that does not is
    longer than the critical step; it is discarded, and the next one is half as long.
    Where the critical step is so short that the shots stall, the straight line is cut
    into segments instead, as few as `aim` can meet.

    Start and goal have shape (n,), and the goal is missed by the tolerance at most, in
    the metric. The coordinates of the execution are not `fewest`.

    Raises:
        ValueError: The execution leaves the choice of coordinates open, or an end is
            misshapen or not finite.
        ConvergenceError: The shots do not come closer, or not within `max_shots`.

    Example:
        >>> from planner import EXAMPLES, Execution, extend, steer
        >>> extended = extend(EXAMPLES["car"], ["drive", "turn", "[drive,turn]"])
        >>> execution = Execution(coordinates="backward")
        >>> shots = steer(extended, (0, 0, 0), (0, 1, 0), execution)
        >>> bool(shots.distances[-1] < 1e-9)
        True
    """
    way = line(start, goal)
    here, end = way(0.0), way(1.0)

    def apart(x: Array, y: Array) -> float:
        return float(extended.system.length(x - y))

    shots, distances = list[Shot](), [apart(end, here)]
    part, critical, hopeful = 1.0, np.inf, True
    while distances[-1] > tolerance:
        tick(f"{len(shots)} shots, which end {distances[-1]:.3g} off the goal")
        earlier = distances[-1 - STALLED] if len(distances) > STALLED else np.inf
        stalled = distances[-1] > earlier / 2
        if hopeful and (stalled or part < FINEST):
            if aimed := _aimed_pieces(extended, way, execution, tolerance):
                shots, distances[1:] = aimed, [apart(end, shot.end) for shot in aimed]
                break
            hopeful = False
        if len(shots) >= max_shots or part < FINEST:
            facts = {"count": len(shots), "distance": distances[-1]}
            raise ConvergenceError(message("shots", tolerance=tolerance, **facts))
        target = here + part * (end - here)
        shot = shot_towards(extended, here, target, execution)
        length = apart(target, here)
        if apart(target, shot.end) > length / 2:
            critical, part = min(critical, length), part / 2
            continue
        shots.append(shot)
        here, part = shot.end, min(1.0, 2 * part)
        distances.append(apart(end, here))
    nominal = np.array([*([shot.start for shot in shots] or [here]), end])
    planned = _assembled(extended, shots, nominal, execution)
    return Steered(planned, tuple(distances), float(critical))


def _aimed_pieces(
    extended: ExtendedSystem, way: Path, execution: Execution, tolerance: float
) -> list[Shot] | None:
    """Shots along the fewest pieces of a path that can be aimed."""
    for pieces in AIMED_PIECES:
        targets = way.at(np.linspace(0.0, 1.0, pieces + 1))
        with suppress(PlannerError):
            return _aimed_along(targets, extended, execution, tolerance)
    return None


def shot_towards(
    extended: ExtendedSystem, here: Array, target: Array, execution: Execution
) -> Shot:
    """A plan of one straight segment between configurations (n,), and its rollout."""
    orders = CHOICES[execution.coordinates][0]
    if len(orders) > 1:
        raise ValueError(message("fewest"))
    samples = sample(line(here, target), extended.system, 1, SEGMENT_NODES)
    inputs = fictitious_inputs_along(extended, samples)
    coordinates = extended.steering.hall_coordinates(inputs)
    (word,) = extended.steering.words(coordinates, orders[0], here[None])
    flows = extended.grouper.flows(word, tuple(range(len(word.fields))))
    return Shot(here, inputs, coordinates, play(extended.system, flows, here)[-1])


def _assembled(
    extended: ExtendedSystem, shots: list[Shot], nominal: Array, execution: Execution
) -> Plan:
    shots = shots or [shot_towards(extended, nominal[0], nominal[0], execution)]
    inputs = np.concatenate([shot.inputs for shot in shots])
    coordinates = np.concatenate([shot.hall_coordinates for shot in shots])
    return assemble(extended, inputs, coordinates, nominal, execution)


def plan_step(
    extended: ExtendedSystem, state: ArrayLike, target: ArrayLike, execution: Execution
) -> Step:
    """Plan one straight segment from a reached state, as far as limits allow.

    Takes configurations of shape (n,). `finish=False` in the execution leaves the legs
    where they are at the end. Raises `RangeError` if even the smallest step leaves the
    limits.
    """

    def straight(goal: Array) -> Plan:
        return follow_path(extended, line(state, goal), 1, execution, SEGMENT_NODES)

    state, target = np.asarray(state, float), np.asarray(target, float)
    best, low, high, share = None, 0.0, 1.0, 1.0
    while high - low > max(FINEST, 1e-3 * low):
        goal = target if share == 1.0 else state + share * (target - state)
        try:
            best, low = straight(goal), share
        except RangeError as error:
            high, refusal = share, error
        share = (low + high) / 2
    if best is None:
        raise refusal
    return Step(best, low)
