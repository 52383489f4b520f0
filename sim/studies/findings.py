"""What a sweep has found: classes of points, and which settings matter.

How much of what varies in the results a setting alone explains is the first-order index
of Sobol's decomposition, estimated from whatever points there are: the variance of the
means of groups of equal or neighbouring values, as a share of the whole variance, less
what chance alone would give.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from planner import Array
from sim.scenarios.predictions import PREDICTIONS
from sim.studies.results import CLASSES, FELL, NO_WALK, Results

FEW = 12  # values, of which each is a group of its own
BINS = (4, 24)  # groups of neighbouring values otherwise, at least and at most
EACH = 12  # points that a group should have


def explained(values: Sequence[Any], results: Array) -> float | None:
    """Share of the variance of results that one setting alone explains, from 0 to 1.

    Points whose result is NaN are left out. None where nothing varies, or where every
    group has a single point.
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
    """Number of each point's group of equal or neighbouring values, shape (N,)."""
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


ROUNDING_SHARE = 1e-9  # share of the path; smaller ones are rounding
PRINTED_REASONS = 5


def findings(results: Results) -> dict[str, Any]:
    """Points in each class, and how much every setting alone explains."""
    counts: Array = np.bincount(results.classes, minlength=len(CLASSES))
    off = np.log10(np.maximum(results.off, ROUNDING_SHARE))
    off[results.classes >= FELL] = np.nan
    lost = (results.classes >= FELL).astype(float)
    matters = {
        key: {
            "departure": explained(results.columns[key], off),
            "falls": explained(results.columns[key], lost),
        }
        for key in results.keys
    }
    statuses = results.columns["status"]
    reasons = Counter(status for status in statuses if status != "ok")
    return {
        "points": len(results),
        "prediction": results.prediction,
        "classes": dict(zip(CLASSES, counts.tolist(), strict=True)),
        "explained": matters,
        "reasons": dict(reasons.most_common(PRINTED_REASONS)),
    }


def describe(found: dict[str, Any]) -> Iterator[str]:
    """Findings, line by line."""
    name = PREDICTIONS[found["prediction"]].label
    yield f"{found['points']} points, farthest off the {name} prediction on the way"
    for word, count in found["classes"].items():
        share = count / max(found["points"], 1)
        yield f"{word:14}{count:6} {share:7.1%}"
    for reason, count in found["reasons"].items():
        yield f"{CLASSES[NO_WALK]:14}{count:6}  {reason}"
    yield ""
    yield f"{'alone explains':24}{'of departures':>14}{'of lost walks':>15}"
    matters = found["explained"]
    for key in sorted(matters, key=lambda one: -(matters[one]["departure"] or 0.0)):
        shares = (_share(matters[key][what]) for what in ("departure", "falls"))
        yield f"{key:24}{next(shares):>14}{next(shares):>15}"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.0%}"
