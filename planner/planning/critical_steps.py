"""The critical step: how long a straight step may be for a single plan to contract it.

A plan that at least halves the distance to its target converges to it when it is
repeated from where it ended (Sec. 2.1, and the critical algorithm of the paper's
reference [3]). The part of a step that a plan leaves grows with the step from zero on,
though not evenly, and the critical step is the smallest one of which more than half is
left. Lengths are those of the metric of the system.

Steps along a ray are planned and played many at once: on a coarse scale first, until
one fails, then closely wherever a notable part is left, and around all maxima of it.
"""

from collections.abc import Callable
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import BudgetError, PlannerError, message
from planner.execution.execution import CHOICES, Execution
from planner.extension.bracket_fields import hall_fields
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.numerics.collocation import collocation
from planner.numerics.subspaces import null_space
from planner.planning.nominal import extend_along, fictitious_inputs_along, sample
from planner.planning.paths import line
from planner.planning.shooting import SEGMENT_NODES
from planner.support.stopping import tick
from planner.systems.flows import word_ends
from planner.systems.strata import StratifiedSystem

CONTRACTED = 0.5  # part of a step that a plan may leave
SHORTEST, LONGEST = 1e-9, 1e3  # steps that are tried, in the metric
GRAINS = 1e5  # that a step spans at least; a grain is what rounding leaves of a place
COARSEST, COARSE, FINE = 64.0, 2.0, 1.02  # ratios of successive steps
NEARLY = 0.4  # part left at a maximum that may lie higher between the steps tried
BETWEEN = 16  # steps that are tried between two others
AT_ONCE = 128  # steps that are planned at once
FEW = 4  # of them on the coarse scale, whose long steps take long to play
FLOW_NODES = 14  # fewer need more flows halved, more take longer
ACCURACY = 1e-6  # relative, of the critical step
EXACT = 1e-9  # part left by plans that are exact but for rounding
RAYS = 20  # directions for each dimension, among which the least step is looked for
TRIED = 24  # directions around the best one
WIDEST, NARROWEST = 0.6, 4e-3  # how far apart they are

Left = Callable[[Array], Array]  # parts left of steps of given lengths, (steps,)


def critical_step(
    system: StratifiedSystem | ExtendedSystem,
    at: ArrayLike,
    direction: ArrayLike,
    execution: Execution | None = None,
    *,
    within: float = inf,
) -> float:
    """Length of the smallest straight step of which a plan leaves more than half.

    Every shorter step in that direction is at least halved, unless the fields lose rank
    on the way, where no plan is made.

    Args:
        system: System to steer; compiled by `extend` beforehand where speed matters.
        at: Configuration to start from, shape (n,).
        direction: Direction of the step, of any length, shape (n,).
        execution: How to carry the steps out; in backward coordinates if not given, or
            where it leaves the choice of coordinates open.
        within: Length from which on no longer step is tried.

    Returns:
        A length in the metric of the system, infinite where every step that is tried
        serves, as on nilpotent systems, and 0 where none does.

    Raises:
        ValueError: The direction is zero or leaves the bottom stratum, or something is
            misshapen or not finite.

    Example:
        >>> from planner import EXAMPLES, critical_step
        >>> round(critical_step(EXAMPLES["car"], at=(0, 0, 0), direction=(0, 1, 0)), 2)
        1.06
    """
    if (shape := np.shape(direction)) != np.shape(at):
        where = f"a configuration of shape {np.shape(at)}; give both as states"
        raise ValueError(f"direction of shape {shape} at {where}")
    steps = _Steps(system, at, execution)
    way = np.asarray(direction, dtype=float)
    size = float(steps.system.length(way))
    if not 0.0 < size < inf:
        raise ValueError(message("no_direction", size=size))
    ray = way / size
    sample(line(steps.start, steps.start + ray), steps.system, 1, 2)  # on the bottom
    return steps.critical(ray, min(within, LONGEST))


def least_critical_step(
    system: StratifiedSystem | ExtendedSystem,
    at: ArrayLike,
    execution: Execution | None = None,
) -> float:
    """The least of the critical steps in all directions.

    Directions are drawn evenly, and more of them ever closer around the best one, until
    no step fails that is notably shorter than the shortest found. Arguments, result and
    errors are those of `critical_step`.

    Example:
        >>> from planner import EXAMPLES, least_critical_step
        >>> round(least_critical_step(EXAMPLES["car"], at=(0, 0, 0)), 2)
        0.71
    """
    steps = _Steps(system, at, execution)
    weights = steps.system.weights
    slopes = steps.system.level_set(steps.system.bottom).gradients(steps.start)
    tangent = null_space((slopes / weights[:, None]).T)  # orthonormal in the metric
    random = np.random.default_rng(0)

    def rays(drawn: Array) -> Array:
        sizes = np.linalg.norm(drawn, axis=-1, keepdims=True)
        return drawn @ tangent.T / sizes / weights

    size = tangent.shape[1]
    drawn = random.normal(size=(RAYS * size, size))
    drawn = np.concatenate([np.eye(size), -np.eye(size), drawn])
    low = steps.shortest
    for found in _scale(low, LONGEST, COARSEST).tolist():
        left = steps.left(found * rays(drawn[::4]))  # few on this scale
        if left.max() > CONTRACTED:
            left = steps.left(found * rays(drawn))
            break
        low = found
    else:
        return inf
    while left.max() > CONTRACTED:
        best = drawn[left.argmax()]
        found = steps.failing(rays(best), low, found)[1]
        left = steps.left(found / (1.0 + WIDEST**2) * rays(drawn))
    width = WIDEST
    while width > NARROWEST and found > steps.shortest:
        best = best / np.linalg.norm(best)
        drawn = best + width * random.normal(size=(TRIED, size)) / np.sqrt(size)
        shorter = found / (1.0 + width**2)
        left = steps.left(shorter * rays(drawn))
        if left.max() > CONTRACTED:
            best = drawn[left.argmax()]
            lowest = shorter * (1.0 - min(0.5, (2.0 * width) ** 2))
            found = steps.failing(rays(best), lowest, shorter)[1]
        else:
            width *= 0.5  # once none of them is shorter
    return steps.refined(rays(best), found / (1.0 + WIDEST**2), found)


class _Steps:
    """Plans of straight steps from one configuration."""

    def __init__(
        self,
        system: StratifiedSystem | ExtendedSystem,
        at: ArrayLike,
        execution: Execution | None,
    ) -> None:
        stay = line(at, at)
        self.start = stay(0.0)
        self.extended = extend_along(system, None, stay)
        self.system = self.extended.system
        grain = self.system.length(np.spacing(sample(stay, self.system, 1, 2)[0, 0]))
        self.shortest = max(SHORTEST, GRAINS * float(grain))
        orders = CHOICES[execution.coordinates if execution else "backward"][0]
        self.order = "backward" if orders[0] == "alternating" else orders[0]

    def critical(self, ray: Array, longest: float) -> float:
        """The critical step along a ray of length one, up to a longest step."""
        if longest <= self.shortest:
            return inf
        left: Left = lambda lengths: self.left(lengths[:, None] * ray)  # noqa: E731
        steps, parts = _to_failure(left, _scale(self.shortest, longest, COARSE), FEW)
        failed = parts[-1] > CONTRACTED
        if len(steps) == 1 and failed:
            return 0.0
        if (parts[:-1] < EXACT).all() and (not failed or self._is_exact):
            return inf
        notable = np.maximum(parts[:-1], parts[1:]) > 0.05  # are tried closely
        close = [
            _scale(low, high, FINE)[1:] if noted else np.array([high])
            for low, high, noted in zip(steps[:-1], steps[1:], notable, strict=True)
        ]
        steps, parts = _to_failure(left, np.concatenate([steps[:1], *close]))
        inner = parts[1:-1]
        high = (inner >= NEARLY) & (inner >= parts[:-2]) & (inner >= parts[2:])
        for k in np.flatnonzero(high):
            fine, rest = _to_failure(left, np.linspace(steps[k], steps[k + 2], BETWEEN))
            if rest[-1] > CONTRACTED:
                steps, parts = fine, rest
                break
        if parts[-1] <= CONTRACTED:
            return inf
        return self.refined(ray, *steps[-2:].tolist())

    def refined(self, ray: Array, low: float, top: float) -> float:
        """The critical step between one that is contracted and one that is not."""
        while top > low * (1.0 + ACCURACY):
            low, top = self.failing(ray, low, top)
        return low

    def failing(self, ray: Array, low: float, top: float) -> tuple[float, float]:
        """The first of steps up to one that fails, and the last one before it."""
        between = np.geomspace(low, top, BETWEEN + 2)
        fails = self.left(between[1:-1, None] * ray) > CONTRACTED
        first = int(np.append(fails, True).argmax())
        return float(between[first]), float(between[first + 1])

    @property
    def _is_exact(self) -> bool:
        """Whether no bracket beyond those of the words is left."""
        hall, beyond = self.extended.steering.hall, self.extended.steering.degree + 1
        longer = hall_fields(self.system, hall.generators, beyond)
        return len(longer.elements) == len(hall.elements)

    def left(self, steps: Array) -> Array:
        """Part that a plan leaves of each step (steps, n); infinite where none is."""
        tick()
        nodes = collocation(SEGMENT_NODES).nodes
        try:
            samples = self.start + nodes[:, None] * steps[:, None]
            inputs = fictitious_inputs_along(self.extended, samples)
            coordinates = self.extended.steering.hall_coordinates(inputs)
            starts = np.repeat(self.start[None], len(steps), axis=0)
            words = self.extended.steering.words(coordinates, self.order, starts)
        except BudgetError:
            raise
        except PlannerError:
            if len(steps) == 1:
                return np.array([inf])
            half = len(steps) // 2
            return np.concatenate([self.left(steps[:half]), self.left(steps[half:])])
        ends = word_ends(self.system, words, starts, FLOW_NODES)
        missed = self.system.length(starts + steps - ends)
        parts: Array = missed / self.system.length(steps)
        return np.where(np.isfinite(parts), parts, inf)


def _scale(low: float, high: float, ratio: float) -> Array:
    """Lengths between two, both included, of about a given ratio."""
    return np.geomspace(low, high, 2 + int(np.log(high / low) / np.log(ratio)))


def _to_failure(left: Left, steps: Array, block: int = AT_ONCE) -> tuple[Array, Array]:
    """Steps up to the first that fails, and the parts that are left of them."""
    parts = np.empty(0)
    for begin in range(0, len(steps), block):
        parts = np.append(parts, left(steps[begin : begin + block]))
        if (failed := parts > CONTRACTED).any():
            parts = parts[: int(failed.argmax()) + 1]
            break
    return steps[: len(parts)], parts
