"""How plans converge: the rate as segments are added, and how long a step may be.

With n segments, an element of degree d has a coordinate of size 1/n in each of them,
and the flows of its word have length n^(-1/d). A word that is exact to degree k leaves
errors that are products of k + 1 such lengths, so that n segments together miss the
goal by

    n (n^(-1/d))^(k + 1) = n^(-(k + 1 - d)/d),

where d is the highest degree of the brackets that the path requires. If the fields of
this part of the error vanish, there is one more factor, and the error is
n^(-(k + 2 - d)/d). This is the case for walkers with d = k = 2 whose two strokes are
mirror images of each other. If all brackets of degree k + 1 vanish, the plan is exact.

A plan that at least halves the distance to its target converges to it when it is
repeated from where it ended (Sec. 2.1, and the critical algorithm of the paper's
reference [3]). The critical step is how long such a plan may be.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import BudgetError, PlannerError
from planner.execution.execution import CHOICES, Coordinates, Execution
from planner.extension.bracket_fields import HallFields, hall_fields
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Wording
from planner.lie.coordinates import exponential, logarithm
from planner.lie.free_lie import lie_algebra
from planner.numerics.arrays import Array
from planner.planning.nominal import (
    default_nodes,
    extend_along,
    fictitious_inputs_along,
    sample,
)
from planner.planning.paths import Path, line
from planner.planning.shooting import shot_towards
from planner.systems.fields import compile_fields
from planner.systems.strata import StratifiedSystem

ERROR_PLACES = 3  # places on the path where the leading error is looked at
ROUNDED_OFF = 1e-9  # part of a path's inputs, or of an error's terms
DOUBLINGS = 20  # from the given step, or from one of length 1, to infinite ones
HALVINGS = 40  # to one that counts as none
ACCURACY = 1e-3  # relative, of the step


@dataclass(frozen=True)
class ConvergenceOrder:
    """How fast the end of a plan converges."""

    degree: int  # k of the nilpotent approximation
    bracket_degree: int  # d, the highest of the brackets that the path asks for
    order: float  # power of 1/n of the miss with n segments; infinite if exact
    cancelled: bool  # whether the error of degree k + 1 cancels

    def __str__(self) -> str:
        if np.isinf(self.order):
            return f"exact at degree {self.degree}"
        return (
            f"the miss falls as n^-{self.order:.3g} with n segments (degree "
            f"{self.degree} for brackets of degree {self.bracket_degree})"
        )


def faster(
    extended: ExtendedSystem, path: Path, coordinates: Coordinates = "fewest"
) -> dict[str, ConvergenceOrder]:
    """What would make plans converge faster, and the order that each has then."""
    now = convergence_order(extended, path, coordinates)
    offers = dict[str, ConvergenceOrder]()
    if np.isinf(now.order):
        return offers
    if coordinates != "symmetric":
        offers["symmetric words"] = convergence_order(extended, path, "symmetric")
    for degree in (now.degree + 1, now.degree + 2):
        try:
            higher = extended.to_degree(degree)
        except ValueError:
            break  # beyond all use
        found = convergence_order(higher, path, coordinates)
        offers[f"degree {degree}"] = found
        if found.order > now.order:
            break
    return {what: offer for what, offer in offers.items() if offer.order > now.order}


def convergence_order(
    extended: ExtendedSystem, path: Path, coordinates: Coordinates = "fewest"
) -> ConvergenceOrder:
    """The order to expect of plans along a path, found without planning any.

    Args:
        extended: System to steer.
        path: Configurations on the bottom stratum for s in [0, 1].
        coordinates: Words that the plans follow, as in `Execution`.

    Raises:
        ValueError: The path is not finite or not on the bottom stratum.
        PlannerError: The elements do not follow the path.

    Example:
        >>> from planner import StratifiedSystem, convergence_order, extend, line
        >>> fields = {"drive": ["cos(a)", "sin(a)", 0], "turn": [0, 0, 1]}
        >>> car = StratifiedSystem("x y a", {"0": fields}, "0")
        >>> extended = extend(car, ["drive", "turn", "[drive,turn]"])
        >>> print(convergence_order(extended, line((0, 0, 0), (0, 1, 0))))
        the miss falls as n^-0.5 with n segments (degree 2 for brackets of degree 2)
    """
    (samples,) = sample(path, extended.system, 1, default_nodes(1))
    (inputs,) = fictitious_inputs_along(extended, samples[None])
    steering = extended.steering
    k, degrees = steering.degree, np.array(steering.selected_degrees)
    sizes = np.abs(inputs).max(axis=0)
    used = sizes > ROUNDED_OFF * sizes.max(initial=0.0)
    d = int(degrees[used].max(initial=1))
    longer = hall_fields(extended.system, steering.hall.generators, k + 1)
    if not used.any() or max(lie_algebra(longer.elements).degrees) <= k:
        return ConvergenceOrder(k, d, np.inf, cancelled=True)
    places = np.linspace(0, len(samples) - 1, ERROR_PLACES).astype(int)
    leading = np.zeros((ERROR_PLACES, len(steering.basis)))
    leading[:, list(steering.selected)] = inputs[places] * (degrees == d)
    if coordinates == "symmetric":
        cancelled = (k - d) % 2 == 0
    else:
        cancelled = not any(
            _misses(extended, longer, samples[places], leading, wording)
            for wording in set(chain(*CHOICES[coordinates]))
        )
    return ConvergenceOrder(k, d, (k + 1 + cancelled - d) / d, bool(cancelled))


def _misses(
    extended: ExtendedSystem,
    longer: HallFields,
    samples: Array,
    leading: Array,
    wording: Wording,
) -> bool:
    """Whether words miss a motion of their next degree anywhere on the path."""
    steering, k = extended.steering, extended.steering.degree
    algebra = lie_algebra(longer.elements)
    beyond = [j for j, degree in enumerate(algebra.degrees) if degree == k + 1]
    fields = compile_fields(
        [longer.fields[j] for j in beyond],
        extended.system.state,
        [longer.names[j] for j in beyond],
    )
    coordinates = exponential(steering.hall.elements, leading)
    words = steering.words(coordinates, wording, samples)
    size = len(longer.elements)
    unit = dict(zip(steering.hall.generators, np.eye(size), strict=False))
    for x, word in zip(samples, words, strict=True):
        flowed = np.zeros(size)
        for name, duration in zip(word.fields, word.durations, strict=True):
            flowed = exponential(longer.elements, duration * unit[name], flowed)
        missed = logarithm(longer.elements, flowed)[beyond]  # eq. (3)
        columns = fields(x)
        scale = np.abs(columns).max() * np.abs(missed).max()
        if np.abs(columns @ missed).max() > ROUNDED_OFF * scale:
            return True
    return False


def critical_step(
    system: StratifiedSystem | ExtendedSystem,
    at: ArrayLike,
    direction: ArrayLike,
    execution: Execution | None = None,
    *,
    within: float = inf,
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
        within: Length from which on no longer step is tried.

    Returns:
        A length in the mixed unit of the state, infinite where every step that is tried
        serves, as on nilpotent systems, and 0 where none does.

    Raises:
        ValueError: The direction is zero, or something is misshapen or not finite.

    Example:
        >>> from planner import StratifiedSystem, critical_step
        >>> fields = {"drive": ["cos(a)", "sin(a)", 0], "turn": [0, 0, 1]}
        >>> car = StratifiedSystem("x y a", {"0": fields}, "0")
        >>> round(critical_step(car, at=(0, 0, 0), direction=(0, 1, 0)), 2)
        1.06
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
    length = float(np.linalg.norm(step))
    return length * _longest(extended, start, step, execution, within / length)


def _longest(
    extended: ExtendedSystem,
    start: Array,
    step: Array,
    execution: Execution,
    within: float,
) -> float:
    """The critical step as a multiple of the given one; `within` likewise."""

    def serves(factor: float) -> bool:
        target = start + factor * step
        try:
            end = shot_towards(extended, start, target, execution).end
        except BudgetError:
            raise
        except PlannerError:
            return False
        return bool(np.linalg.norm(target - end) <= np.linalg.norm(factor * step) / 2)

    low, unit = 1.0, 1.0 / float(np.linalg.norm(step))
    while not serves(low):
        low /= 2
        if low < 2.0**-HALVINGS:
            return 0.0
    high = 2 * low
    while low >= 1.0 and serves(high):
        low, high = high, 2 * high
        if low >= within or high > 2.0**DOUBLINGS * max(1.0, unit):
            return inf
    while high - low > ACCURACY * high:
        middle = (low + high) / 2
        low, high = (middle, high) if serves(middle) else (low, middle)
    return low
