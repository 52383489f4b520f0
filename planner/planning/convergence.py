"""The rate at which the end of a plan approaches its goal as segments are added.

With n segments, an element of degree d has a coordinate of size 1/n in each of them,
and the flows of its word have length n^(-1/d). A word that is exact to degree k leaves
errors that are products of k + 1 such lengths, so that n segments together miss the
goal by

    n (n^(-1/d))^(k + 1) = n^(-(k + 1 - d)/d),

where d is the highest degree of the brackets that the path requires. If the fields of
this part of the error vanish, there is one more factor, and the error is
n^(-(k + 2 - d)/d). This is the case for walkers with d = k = 2 whose two strokes are
mirror images of each other. If all brackets of degree k + 1 vanish, the plan is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.execution.execution import CHOICES, Coordinates
from planner.extension.bracket_fields import HallFields, hall_fields
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Wording
from planner.lie.coordinates import exponential, logarithm
from planner.lie.free_lie import lie_algebra
from planner.numerics.arrays import Array
from planner.planning.nominal import default_nodes, fictitious_inputs_along, sample
from planner.planning.paths import Path
from planner.systems.fields import compile_fields
from planner.systems.flows import Word

PLACES = 3  # places on the path where the leading error is looked at
NEGLIGIBLE = 1e-9  # part of a path's inputs, or of an error's terms, that is rounding


@dataclass(frozen=True)
class ConvergenceOrder:
    """How fast the end of a plan converges.

    Attributes:
        degree: Degree k of the nilpotent approximation.
        bracket_degree: Highest degree d of the brackets that the path asks for.
        order: Power of 1/n by which n segments miss the goal at least; infinite where
            plans are exact.
        cancelled: Whether the error of degree k + 1 cancels.
    """

    degree: int
    bracket_degree: int
    order: float
    cancelled: bool

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
    """What would make plans converge faster, and the order that each has then.

    Args:
        extended: System to steer.
        path: Configurations on the bottom stratum for s in [0, 1].
        coordinates: Words that are followed now.
    """
    now = convergence_order(extended, path, coordinates)
    offers: dict[str, ConvergenceOrder] = {}
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
    """
    (samples,) = sample(path, extended.system, 1, default_nodes(1))
    (inputs,) = fictitious_inputs_along(extended, samples[None])
    steering = extended.steering
    k, degrees = steering.degree, np.array(steering.selected_degrees)
    sizes = np.abs(inputs).max(axis=0)
    used = sizes > NEGLIGIBLE * sizes.max(initial=0.0)
    d = int(degrees[used].max(initial=1))
    longer = hall_fields(extended.system, steering.hall.generators, k + 1)
    if not used.any() or max(lie_algebra(longer.elements).degrees) <= k:
        return ConvergenceOrder(k, d, np.inf, cancelled=True)
    places = np.linspace(0, len(samples) - 1, PLACES).astype(int)
    leading = np.zeros((PLACES, len(steering.basis)))
    leading[:, list(steering.selected)] = inputs[places] * (degrees == d)
    if coordinates == "symmetric":
        cancelled = (k - d) % 2 == 0
    else:
        wordings = {wording for choice in CHOICES[coordinates] for wording in choice}
        cancelled = not any(
            _misses(extended, longer, samples[places], leading, wording)
            for wording in wordings
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
    words = steering.words(
        exponential(steering.hall.elements, leading), wording, samples
    )
    generators = steering.hall.generators
    for x, word in zip(samples, words, strict=True):
        columns, missed = fields(x), word_logarithm(longer, generators, word)[beyond]
        size = np.abs(columns).max() * np.abs(missed).max()
        if np.abs(columns @ missed).max() > NEGLIGIBLE * size:
            return True
    return False


def word_logarithm(hall: HallFields, generators: Sequence[str], word: Word) -> Array:
    """The logarithm of a word's flow in a Hall basis, shape (s,), eq. (3).

    Args:
        hall: Basis, which may go beyond the degree to which the word is exact.
        generators: Fields by their numbers, from 1.
        word: Flows in time order.
    """
    unit = dict(zip(generators, np.eye(len(hall.elements)), strict=False))
    coordinates = np.zeros(len(hall.elements))
    for name, duration in zip(word.fields, word.durations, strict=True):
        step = duration * unit[name]
        coordinates = exponential(hall.elements, step, coordinates)
    return logarithm(hall.elements, coordinates)
