"""What a sweep has found, in lines for a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from planner import Array
from sim.scenarios.predictions import PREDICTIONS
from sim.studies.results import CLASSES, FELL, NO_WALK, Results
from sim.studies.sensitivity import explained

LEAST = 1e-9  # share of the path; smaller ones are rounding
TOLD = 5  # reasons


def findings(results: Results) -> dict[str, Any]:
    """Points in each class, and how much every setting alone explains.

    Args:
        results: Of a sweep.
    """
    counts: Array = np.bincount(results.classes, minlength=len(CLASSES))
    off = np.log10(np.maximum(results.off, LEAST))
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
        "reasons": dict(reasons.most_common(TOLD)),
    }


def describe(found: dict[str, Any]) -> Iterator[str]:
    """Findings, line by line.

    Args:
        found: What `findings` gives.
    """
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
