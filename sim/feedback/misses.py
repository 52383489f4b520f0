"""What segments miss: how much is expected of any robot, and what was learnt of one.

A motion that is meant to be u becomes u + b + A u and some scatter.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Self

import numpy as np

from planner import Array


def _of(*values: float) -> Array:
    return np.array(values)


@dataclass(frozen=True)
class Misses:
    """Standard deviations of what a segment misses, lengths as shares of a radius.

    The defaults are those of twenty hobby robots, rounded up.

    Attributes:
        bias: Of b before anything is seen, (3,).
        slope: Of A before anything is seen, (3, 3).
        scatter: Of a segment's miss about b + A u, (3,).
        wander: Of the change of b from a segment to the next, (3,).
    """

    bias: Array = field(default_factory=lambda: _of(0.015, 0.015, 0.010))
    slope: Array = field(
        default_factory=lambda: np.outer(_of(1, 1, 0.8), _of(0.1, 0.1, 0.02))
    )
    scatter: Array = field(default_factory=lambda: _of(0.001, 0.001, 0.0012))
    wander: Array = field(default_factory=lambda: _of(0.05e-3, 0.05e-3, 0.05e-3))

    @classmethod
    def none(cls) -> Self:
        """Of a robot whose segments miss nothing that could be learnt."""
        return cls(bias=np.zeros(3), slope=np.zeros((3, 3)), wander=np.zeros(3))


@dataclass(frozen=True)
class Learnt:
    """What a walk has learnt of its robot, for the next walk.

    Attributes:
        bias: b, x and y [m] and yaw [rad], (3,).
        slope: A, (3, 3).
        covariance: Of the entries of b and of the rows of A, (12, 12).
    """

    bias: Array
    slope: Array
    covariance: Array

    def __post_init__(self) -> None:
        shapes = {"bias": (3,), "slope": (3, 3), "covariance": (12, 12)}
        for name, shape in shapes.items():
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(f"{name} must be {shape} finite numbers")
            object.__setattr__(self, name, value)
        if np.linalg.eigvalsh(self.covariance).min() < -1e-12:
            raise ValueError("covariance must be positive semidefinite")

    @property
    def numbers(self) -> tuple[float, ...]:
        """As files have it: b, the rows of A, and the lower half of the covariance."""
        half = self.covariance[np.tril_indices(12)]
        return tuple(np.concatenate([self.bias, self.slope.ravel(), half]).tolist())

    def __str__(self) -> str:
        return f"[learnt]\nnumbers = [{', '.join(map(repr, self.numbers))}]\n"

    @classmethod
    def of(cls, numbers: tuple[float, ...]) -> Self:
        """What files have; a ValueError says what is wrong with it."""
        if len(numbers) != 90:
            raise ValueError(f"90 numbers are needed, got {len(numbers)}")
        half = np.zeros((12, 12))
        half[np.tril_indices(12)] = numbers[12:]
        whole = half + np.tril(half, -1).T
        return cls(np.array(numbers[:3]), np.reshape(numbers[3:12], (3, 3)), whole)
