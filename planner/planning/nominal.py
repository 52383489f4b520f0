"""From a nominal path to fictitious inputs, eq. (5): segments, samples, elements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral

import numpy as np

from planner.errors import PlannerError, point
from planner.extension.choice import choose_elements
from planner.extension.extended import ExtendedSystem, extend
from planner.numerics.arrays import Array
from planner.numerics.collocation import collocation
from planner.planning.paths import Path, grid
from planner.systems.strata import StratifiedSystem

CHOICE_NODES = 7  # configurations of a path at which chosen elements must span
MOST_SEGMENTS = 100_000  # of one plan; so many take a minute and a gigabyte
OFF_BOTTOM = 1e-6  # by which a path may miss the level sets, in their unit


def require_segments(segments: int, path: Path) -> None:
    """Check the number of segments of a path.

    Args:
        segments: The number.
        path: Path that is divided into segments.

    Raises:
        ValueError: It is not a whole number from 1 to `MOST_SEGMENTS`.
        PlannerError: It is too small for a division at every corner of the path.
    """
    whole = isinstance(segments, Integral) and not isinstance(segments, bool)
    if not whole or not 1 <= segments <= MOST_SEGMENTS:
        raise ValueError(
            f"segments is {segments}; a whole number from 1 to {MOST_SEGMENTS} is "
            "needed"
        )
    if segments <= len(path.corners):
        raise PlannerError(
            f"segments is {segments}, which cuts corners of a path that has "
            f"{len(path.corners)}; plan at least {len(path.corners) + 1} segments"
        )


def default_nodes(segments: int) -> int:
    """Number of nodes of a segment; all segments together resolve a few turns."""
    return max(5, 1 + math.ceil(40 / segments))


def sample(path: Path, system: StratifiedSystem, segments: int, nodes: int) -> Array:
    """Configurations at the nodes of each segment, shape (segments, nodes, n).

    Raises:
        ValueError: The path does not match the state, is not finite, or leaves the
            bottom stratum.
    """
    cuts = grid(path, segments)
    inner = cuts[:-1, None] + np.diff(cuts)[:, None] * collocation(nodes).nodes[:-1]
    parameters = np.append(inner.ravel(), 1.0)
    values = path.at(parameters)
    _require_sound(values, parameters, system)
    starts = values[:-1].reshape(segments, nodes - 1, -1)
    ends = values[nodes - 1 :: nodes - 1, None]
    return np.concatenate([starts, ends], axis=1)


def _require_sound(values: Array, parameters: Array, system: StratifiedSystem) -> None:
    if values.shape != (parameters.size, system.dimension):
        raise ValueError(
            f"path returns shape {values.shape[1:]}, expected ({system.dimension},): "
            f"{', '.join(map(str, system.state))}"
        )
    finite = np.isfinite(values).all(axis=1)
    if not finite.all():
        raise ValueError(f"path is not finite at s = {parameters[~finite][0]:.6g}")
    bottom = system.level_set(system.bottom)
    missed = np.abs(bottom.value(values)) if bottom.functions else np.zeros((1, 1))
    if missed.max() > OFF_BOTTOM:
        k, i = np.unravel_index(missed.argmax(), missed.shape)
        raise ValueError(
            f"path leaves S{system.bottom} at s = {parameters[k]:.6g}, where "
            f"{bottom.functions[i]} is not 0 at {point(values[k])}"
        )


def extend_along(
    system: StratifiedSystem | ExtendedSystem,
    elements: Sequence[str] | None,
    path: Path,
) -> ExtendedSystem:
    """The extended system of given elements, or of elements that suit a path.

    Args:
        system: System to extend; an extended one is returned unchanged.
        elements: Fields and brackets; chosen by `extension.choice` if not given.
        path: Path along which the elements must span the bottom stratum.

    Raises:
        ValueError: An element is unknown or not an element, or elements are given
            although the system is extended already.
        PlannerError: The elements cannot be used, or none can be chosen.
    """
    if isinstance(system, ExtendedSystem):
        if elements is not None:
            raise ValueError("elements are given twice: the system is extended already")
        return system
    if elements is None:
        (samples,) = sample(path, system, 1, CHOICE_NODES)
        elements = choose_elements(system, samples).elements
    return extend(system, elements)


def fictitious_inputs_along(extended: ExtendedSystem, samples: Array) -> Array:
    """Inputs v of eq. (5) that follow each sampled segment in unit time.

    The path is differentiated as the polynomial through its samples, so that the
    integral of its velocity meets the end of the segment exactly. Inputs are zero where
    the path does not move.

    Args:
        extended: System to steer.
        samples: Configurations, shape (segments, nodes, n).

    Returns:
        Shape (segments, nodes, p).
    """
    segments, nodes, _ = samples.shape
    inputs = np.zeros((segments, nodes, len(extended.elements)))
    moving = np.ptp(samples, axis=1).any(axis=1)
    if moving.any():
        velocity = collocation(nodes).derivative @ samples[moving]
        inputs[moving] = extended.fictitious_inputs(samples[moving], velocity)
    return inputs
