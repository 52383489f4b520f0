"""Check that fictitious inputs follow the path between nodes as well as at them.

Inputs are polynomials through their values at nodes. If the elements lose rank or are
singular between two nodes, no polynomial follows the path there, and the values at the
nodes do not show it. A loss of rank at a node is detected by `extension.extended`.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev

from planner.errors import PlannerError, ResolutionError, point
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import ROUNDING, Array
from planner.numerics.collocation import collocation

TAIL = 1e-3  # part of inputs in the last terms of their series that needs a check
MISSED = 0.2  # relative part of a velocity; resolved inputs miss a hundredth


def require_regular(extended: ExtendedSystem, samples: Array, inputs: Array) -> None:
    """Check that inputs follow a path between its nodes.

    Shots (`planning.shooting`) do not need this check, since each is rolled out.

    Args:
        extended: System to steer.
        samples: Configurations at nodes of segments in order, (segments, nodes, n).
        inputs: Inputs that follow them, shape (segments, nodes, p).

    Raises:
        PlannerError: The determinant of the elements changes its sign along a segment;
            the message gives the nodes on both sides.
        ResolutionError: Midway between nodes the inputs do not give the velocity,
            because the elements lose rank or because the path turns too fast.
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
            at = _steepest(inputs[rough][worst])
            lost = moving[rough][~(missed <= MISSED)]
            raise ResolutionError(_refusal(samples[rough][worst], at), lost.tolist())


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


def _steepest(inputs: Array) -> int:
    """The first of the two neighbouring nodes where inputs (nodes, p) are largest."""
    largest = np.abs(inputs).max(axis=0)
    sizes = (np.abs(inputs) / np.where(largest > 0.0, largest, 1.0)).sum(axis=-1)
    return int((sizes[1:] + sizes[:-1]).argmax())


def _refusal(x: Array, node: int) -> str:
    return (
        f"between {point(x[node])} and {point(x[node + 1])} the elements lose rank or "
        "are singular (Def. 3), or the path turns too fast to be followed; keep it "
        "away from there, add fields or brackets, or plan more segments"
    )
