"""From a nominal path to fictitious inputs, eq. (5): segments, samples, elements.

Inputs are polynomials through their values at nodes. If the elements lose rank or are
singular between two nodes, no polynomial follows the path there, and the values at the
nodes do not show it; `require_regular` looks between them.
"""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from numbers import Integral
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev

from planner.errors import PlannerError, ResolutionError, message, point
from planner.execution.execution import Execution
from planner.extension.choice import Choice, choose_elements
from planner.extension.extended import KEPT, ExtendedSystem, extend
from planner.numerics.arrays import ROUNDING, Array
from planner.numerics.collocation import collocation
from planner.planning.paths import Path, grid
from planner.systems.flows import Flow, flow_map
from planner.systems.strata import StratifiedSystem

CHOICE_NODES = 7  # configurations of a path at which chosen elements must span
MOST_SEGMENTS = 100_000  # of one plan; so many take a minute and a gigabyte
OFF_BOTTOM = 1e-6  # by which a path may miss the level sets, in their unit
ROUNDED_OFF = 1e-9  # length that rounding may take from each step of a path
TAIL = 1e-3  # part of inputs in the last terms of their series that needs a check
STILL = 1e-100  # extent of a segment whose parts have products that underflow
MISSED = 0.2  # relative part of a velocity; resolved inputs miss a hundredth


class Steerable(Protocol):
    """A system that knows how it is best steered, such as the equations of a robot."""

    @property
    def system(self) -> StratifiedSystem:
        """The stratified system."""

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements of the extended system to steer with."""

    @property
    def execution(self) -> Execution:
        """How plans are carried out: order of flows, joint ranges, static stability."""

    def configurations(self, path: Path) -> Path:
        """The path as one of configurations, if it consists of poses of the body."""


def require_segments(segments: int, path: Path) -> None:
    """Check that segments are a whole number, and enough for the path's corners."""
    whole = isinstance(segments, Integral) and not isinstance(segments, bool)
    if not whole or not 1 <= segments <= MOST_SEGMENTS:
        raise ValueError(message("segments", given=segments, most=MOST_SEGMENTS))
    if segments <= len(path.corners):
        facts = {"corners": len(path.corners), "least": len(path.corners) + 1}
        raise PlannerError(message("corners", given=segments, **facts))


def default_nodes(segments: int) -> int:
    """Number of nodes of a segment; all segments together resolve a few turns."""
    return max(5, 1 + math.ceil(40 / segments))


def sample(path: Path, system: StratifiedSystem, segments: int, nodes: int) -> Array:
    """Configurations at the nodes of each segment, shape (segments, nodes, n).

    A path that does not match the state, is not finite, is too far away for the
    precision of floats, or leaves the bottom stratum is refused.
    """
    cuts = grid(path, segments)
    inner = cuts[:-1, None] + np.diff(cuts)[:, None] * collocation(nodes).nodes[:-1]
    parameters = np.append(inner.ravel(), 1.0)
    values = path.at(parameters)
    if values.shape != (parameters.size, system.dimension):
        state = ", ".join(map(str, system.state))
        shapes = {"given": values.shape[1:], "dimension": system.dimension}
        raise ValueError(message("shape", state=state, **shapes))
    finite = np.isfinite(values).all(axis=1)
    if not finite.all():
        raise ValueError(f"path is not finite at s = {parameters[~finite][0]:.6g}")
    lost = (np.spacing(np.abs(values)) * system.weights).max(axis=1)
    if lost.max() > ROUNDED_OFF:
        place = point(values[lost.argmax()])
        raise ValueError(message("rounded", place=place, lost=lost.max()))
    bottom = system.level_set(system.bottom)
    missed = np.abs(bottom.value(values)) if bottom.functions else np.zeros((1, 1))
    if missed.max() > OFF_BOTTOM:
        k, i = np.unravel_index(missed.argmax(), missed.shape)
        facts = {"function": bottom.functions[i], "place": point(values[k])}
        raise ValueError(message("off", bottom=system.bottom, s=parameters[k], **facts))
    starts = values[:-1].reshape(segments, nodes - 1, -1)
    return np.concatenate([starts, values[nodes - 1 :: nodes - 1, None]], axis=1)


def extend_along(
    system: StratifiedSystem | ExtendedSystem, names: Iterable[str] | None, path: Path
) -> ExtendedSystem:
    """The extended system of elements of some names, or of those that span on a path.

    They are chosen by `extension.choice` if none are given. A system that is extended
    already is returned unchanged.
    """
    if isinstance(system, ExtendedSystem):
        if names is not None:
            raise ValueError("elements are given twice: the system is extended already")
        return system
    if names is None:
        names = _chosen(system, sample(path, system, 1, CHOICE_NODES).tobytes())
    return extend(system, names)


@lru_cache(maxsize=KEPT)
def _chosen(system: StratifiedSystem, samples: bytes) -> Choice:
    return choose_elements(system, np.frombuffer(samples).reshape(-1, system.dimension))


def fictitious_inputs_along(extended: ExtendedSystem, samples: Array) -> Array:
    """Inputs v of eq. (5), shape (segments, nodes, p), that follow sampled segments.

    The path is differentiated as the polynomial through its samples, so that the
    integral of its velocity meets the end of the segment exactly. Redundant elements
    are weighed by the units of their inputs.
    """
    segments, nodes, _ = samples.shape
    inputs = np.zeros((segments, nodes, len(extended.elements)))
    moving = (np.ptp(samples, axis=1) > STILL).any(axis=1)
    if moving.any():
        velocity = collocation(nodes).derivative @ samples[moving]
        units = extended.steering.element_units(samples[0, 0])
        inputs[moving] = extended.fictitious_inputs(samples[moving], velocity, units)
    return inputs


def require_regular(extended: ExtendedSystem, samples: Array, inputs: Array) -> None:
    """Check that inputs follow a path between its nodes as well as at them.

    A loss of rank at a node is detected by `extension.extended`, one between nodes by
    the sign of the determinant of the elements at both. A `ResolutionError` says that
    inputs do not give the velocity midway. Shots do not need this check, since each is
    rolled out. Shapes are as in `fictitious_inputs_along`.
    """
    moving = np.flatnonzero(np.ptp(samples, axis=1).any(axis=1))
    if not len(moving):
        return
    samples, inputs = samples[moving], inputs[moving]
    ends = extended.orientations(np.append(samples[:, 0], samples[-1:, -1], axis=0))
    for segment in samples[ends[1:] != ends[:-1]][:1]:
        signs = extended.orientations(segment)
        raise PlannerError(_refusal(segment, int(np.argmax(signs[1:] != signs[:-1]))))
    rule = collocation(samples.shape[1])
    tails = np.abs(rule.coefficients[-2:] @ inputs).max(axis=1)  # (segments, p)
    rough = (tails > TAIL * np.abs(inputs).max(axis=1)).any(axis=1)
    if rough.any():
        missed = _missed(extended, samples[rough], inputs[rough]).max(axis=-1)
        if not missed.max() <= MISSED:
            worst = int(missed.argmax())
            steep = np.abs(inputs[rough][worst])
            largest = steep.max(axis=0)
            sizes = (steep / np.where(largest > 0.0, largest, 1.0)).sum(axis=-1)
            at = int((sizes[1:] + sizes[:-1]).argmax())
            lost = moving[rough][~(missed <= MISSED)]
            raise ResolutionError(_refusal(samples[rough][worst], at), lost.tolist())


def require_use(
    extended: ExtendedSystem, nominal: Array, flows: Sequence[Flow]
) -> None:
    """Refuse flows on nearly singular elements that end no nearer to their goal."""
    system = extended.system
    way = float(system.length(nominal[-1] - nominal[0]))
    units = extended.steering.element_units(nominal[0])
    matrix = extended.columns.values(nominal) * system.weights[:, None]
    scaled = matrix if units is None else matrix * units
    singular = np.linalg.svd(scaled, compute_uv=False)
    least = singular[:, system.bottom_dimension - 1]
    if not way or (least >= 1e-6 * singular[:, 0]).all():  # no need to play
        return
    end = nominal[0]
    for flow in flows:
        end = flow_map(system, flow.field, end, flow.duration)
    missed = float(system.length(nominal[-1] - end) / way)
    if missed > 0.9:  # part of the way, by a plan of no use
        worst = nominal[(least / singular[:, 0]).argmin()]
        facts = {"missed": 100 * missed, "place": point(worst)}
        raise PlannerError(message("nearly_singular", **facts))


def _missed(extended: ExtendedSystem, samples: Array, inputs: Array) -> Array:
    """Relative part of the velocity missed midway, shape (segments, nodes - 1)."""
    rule = collocation(samples.shape[1])
    midway = rule.nodes[1:] + rule.nodes[:-1] - 1.0  # of [-1, 1]
    between = chebyshev.chebvander(midway, len(rule.nodes) - 1) @ rule.coefficients
    matrix = extended.columns.values(between @ samples)
    given = matrix * (between @ inputs)[..., None, :]
    velocity = rule.derivative @ samples
    noise = ROUNDING * np.abs(rule.derivative).sum(axis=1).max() * np.abs(samples).max()
    size = np.abs(given).sum(axis=-1).max(axis=1, keepdims=True) + noise
    missed = np.abs(given.sum(axis=-1) - between @ velocity)
    return (missed / np.where(size > 0.0, size, 1.0)).max(axis=-1)


def _refusal(x: Array, node: int) -> str:
    return message("singular_between", start=point(x[node]), end=point(x[node + 1]))
