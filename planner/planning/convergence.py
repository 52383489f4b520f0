"""How plans converge as segments are added.

With n segments, an element of degree d has a coordinate of size 1/n in each of them,
and the flows of its word have length n^(-1/d). A word that is exact to degree k leaves
errors that are products of k + 1 such lengths, so that n segments together miss the
goal by n (n^(-1/d))^(k + 1) = n^(-(k + 1 - d)/d), where d is the highest degree of the
brackets that the path requires. If the fields of this part of the error vanish, as for
walkers with d = k = 2 whose two strokes are mirror images of each other, there is one
more factor. If all brackets of degree k + 1 vanish, the plan is exact.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from planner.execution.execution import CHOICES, Coordinates
from planner.extension.bracket_fields import HallFields, hall_fields
from planner.extension.extended import ExtendedSystem
from planner.extension.rectangles import weights
from planner.extension.steering import Wording
from planner.lie.coordinates import exponential, logarithm
from planner.lie.free_lie import lie_algebra
from planner.numerics.arrays import Array
from planner.planning.nominal import default_nodes, fictitious_inputs_along, sample
from planner.planning.paths import Path
from planner.systems.fields import compile_fields

ERROR_PLACES = 3  # places on the path where the leading error is looked at
ROUNDED_OFF = 1e-9  # part of a path's inputs, or of an error's terms


@dataclass(frozen=True)
class ConvergenceOrder:
    """How fast the end of a plan converges."""

    degree: int  # k of the nilpotent approximation
    bracket_degree: int  # d, the highest of the brackets that the path asks for
    order: float  # power of 1/n of the miss with n segments; infinite if exact

    def __str__(self) -> str:
        if np.isinf(self.order):
            return f"exact at degree {self.degree}"
        return (
            f"the miss falls as n^-{self.order:.3g} with n segments (degree "
            f"{self.degree} for brackets of degree {self.bracket_degree})"
        )


def faster(
    extended: ExtendedSystem,
    path: Path,
    now: ConvergenceOrder,
    coordinates: Coordinates = "fewest",
) -> dict[str, ConvergenceOrder]:
    """What would make plans converge faster than now, and the order of each then."""
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

    The path gives configurations on the bottom stratum for s in [0, 1]; the coordinates
    are those of `Execution`.

    Raises:
        ValueError: The path is not finite or not on the bottom stratum.
        PlannerError: The elements do not follow the path.

    Example:
        >>> from planner import EXAMPLES, convergence_order, extend, line
        >>> extended = extend(EXAMPLES["car"], ["drive", "turn", "[drive,turn]"])
        >>> print(convergence_order(extended, line((0, 0, 0), (0, 1, 0))))
        the miss falls as n^-0.5 with n segments (degree 2 for brackets of degree 2)
    """
    (samples,) = sample(path, extended.system, 1, default_nodes(1))
    (inputs,) = fictitious_inputs_along(extended, samples[None])
    steering = extended.steering
    k, degrees = steering.degree, np.array(steering.selected_degrees)
    moved = extended.columns(samples) * inputs[:, None]  # (nodes, n, p)
    sizes = extended.system.length(np.swapaxes(moved, -1, -2)).max(axis=0)
    used = sizes > ROUNDED_OFF * sizes.max(initial=0.0)
    d = int(degrees[used].max(initial=1))
    longer = hall_fields(extended.system, steering.hall.generators, k + 1)
    if not used.any() or max(lie_algebra(longer.elements).degrees) <= k:
        return ConvergenceOrder(k, d, np.inf)
    places = np.linspace(0, len(samples) - 1, ERROR_PLACES).astype(int)
    leading = np.zeros((ERROR_PLACES, len(steering.basis)))
    leading[:, list(steering.selected)] = inputs[places] * (degrees == d)
    if coordinates == "symmetric":
        cancelled = (k - d) % 2 == 0
    else:
        words = set(chain(*CHOICES[coordinates]))
        cancelled = not _misses(extended, longer, samples[places], leading, words)
    return ConvergenceOrder(k, d, (k + 1 + cancelled - d) / d)


def _misses(
    extended: ExtendedSystem,
    longer: HallFields,
    samples: Array,
    leading: Array,
    wordings: Iterable[Wording],
) -> bool:
    """Whether any words miss a motion of their next degree anywhere on the path."""
    steering, k = extended.steering, extended.steering.degree
    algebra = lie_algebra(longer.elements)
    beyond = [j for j, degree in enumerate(algebra.degrees) if degree == k + 1]
    tops = [longer.elements[j] for j in beyond]
    own, names = ([of[j] for j in beyond] for of in (longer.fields, longer.names))
    fields = compile_fields(own, extended.system.state, names)
    spelled = steering.speller(exponential(steering.hall.elements, leading), samples)
    words = [pair for w in wordings for pair in zip(samples, spelled(w), strict=True)]
    size = len(longer.elements)
    unit = dict(zip(steering.hall.generators, np.eye(size), strict=False))  # more rows
    for x, word in words:
        flowed = np.zeros(size)
        for name, duration in zip(word.fields, word.durations, strict=True):
            flowed = exponential(longer.elements, duration * unit[name], flowed)
        missed = logarithm(longer.elements, flowed)[beyond]  # eq. (3)
        columns = fields(x) * extended.system.weights[:, None]
        if steering.rectangles:  # units that hide no term behind another's rounding
            units = weights(tops, steering.rectangles.units.at(x))
            columns, missed = columns * units, missed / units
        scale = np.abs(columns).max() * np.abs(missed).max()
        if np.abs(columns @ missed).max() > ROUNDED_OFF * scale:
            return True
    return False
