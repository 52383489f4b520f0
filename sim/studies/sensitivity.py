"""How much of what varies in a sweep's results a setting alone explains.

This is the first-order index of Sobol's decomposition, estimated from whatever points
there are: the variance of the means of groups of equal or neighbouring values, as a
share of the whole variance, less what chance alone would give.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from planner import Array

FEW = 12  # values, of which each is a group of its own
BINS = (4, 24)  # groups of neighbouring values otherwise, at least and at most
EACH = 12  # points that a group should have


def explained(values: Sequence[Any], results: Array) -> float | None:
    """Share of the variance of results that one setting alone explains.

    Args:
        values: The setting at each point.
        results: Shape (N,); points whose result is NaN are left out.

    Returns:
        From 0 to 1; None where nothing varies, or every group has a single point.
    """
    known = np.isfinite(results)
    groups = group(values)[known]
    results = results[known]
    _, groups = np.unique(groups, return_inverse=True)
    count = int(groups.max()) + 1 if len(groups) else 0
    total = float(((results - results.mean()) ** 2).sum()) if len(results) else 0.0
    if count < 2 or len(results) <= count or total <= 0:
        return None
    sizes = np.bincount(groups)
    means = np.bincount(groups, results) / sizes
    within = float(((results - means[groups]) ** 2).sum())
    chance = within / (len(results) - count) * (len(results) - 1)
    return float(np.clip(1.0 - chance / total, 0.0, 1.0))


def group(values: Sequence[Any]) -> Array:
    """Number of each point's group of equal or neighbouring values, shape (N,).

    Args:
        values: The setting at each point, of any type.
    """
    distinct = sorted(set(map(_comparable, values)))
    place = {value: number for number, value in enumerate(distinct)}
    ranks = np.array([place[_comparable(value)] for value in values], dtype=int)
    if len(distinct) <= FEW:
        return ranks
    bins = int(np.clip(len(ranks) // EACH, *BINS))
    return ranks * bins // len(distinct)


def _comparable(value: Any) -> tuple[str, Any]:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return ("", float(value)) if number else (type(value).__name__, str(value))
