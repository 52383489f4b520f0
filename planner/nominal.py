"""Samples of a nominal path, and the fictitious inputs that follow it (eq. 5)."""

from __future__ import annotations

import math

import numpy as np

from planner.collocation import collocation
from planner.errors import point
from planner.extended import ExtendedSystem
from planner.fields import Array
from planner.paths import Path, grid
from planner.strata import StratifiedSystem

OFF_BOTTOM = 1e-6  # of the level sets, in their unit, that a path may miss


def default_nodes(segments: int) -> int:
    """Nodes a segment; together they resolve a path of a few turns."""
    return max(5, 1 + math.ceil(40 / segments))


def sample(path: Path, system: StratifiedSystem, segments: int, nodes: int) -> Array:
    """Configurations at the nodes of each segment, shape (segments, nodes, n).

    Raises:
        ValueError: The path's shape does not match the state, it is not finite, or it
            leaves the bottom stratum.
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


def fictitious_inputs(extended: ExtendedSystem, samples: Array) -> Array:
    """Inputs that follow sampled segments in unit time each, zero where nothing moves.

    The path is differentiated as the polynomial through its samples, so that the
    integral of its velocity meets the segment's end exactly.

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
