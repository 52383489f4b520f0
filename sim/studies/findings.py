"""What a sweep's table says: how well a prediction holds, and which settings matter.

What a setting alone explains is the first-order index of Sobol's decomposition: the
variance of the means of groups of equal values over the whole one, exact where the
points fill a grid, else estimated with groups of neighbouring values.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from planner import Array
from sim.errors import message
from sim.scenarios.predictions import PREDICTIONS
from sim.studies.results import FELL, Results
from sim.templates import render

SEPARATE = 12  # values, of which each is a group of its own
BINS = (4, 24)  # groups of neighbouring values otherwise, at least and at most
EACH = 12  # points that a group should have
NUMBER = re.compile(r"(?<![\w-])-?\d[\d.e-]*")  # in which alone many reasons differ


def explained(values: Sequence[object], results: Array, exact: bool) -> float | None:
    """Share of the variance of results that one setting alone explains, from 0 to 1.

    Points whose result is NaN are left out. None where nothing varies, or where every
    group has a single point. It is `exact` where the points are all of a grid: groups
    then differ by the setting alone, and within them the others vary, not chance.
    """
    known = np.isfinite(results)
    results = results[known] - results[known][:1]  # equal ones are exactly 0
    distinct, groups = np.unique(group(values, exact)[known], return_inverse=True)
    count = len(distinct)
    if count < 2 or len(results) <= count:
        return None
    total = float(((results - results.mean()) ** 2).sum())
    if total <= 0:
        return None
    means = np.bincount(groups, results) / np.bincount(groups)
    within = float(((results - means[groups]) ** 2).sum())
    chance = 1.0 if exact else (len(results) - 1) / (len(results) - count)
    return float(np.clip(1.0 - chance * within / total, 0.0, 1.0))


def group(values: Sequence[object], separate: bool = False) -> Array:
    """Number of each point's group of equal or neighbouring values, shape (N,)."""
    comparable = list(map(_comparable, values))
    place = {value: number for number, value in enumerate(sorted(set(comparable)))}
    ranks = np.array([place[value] for value in comparable], dtype=int)
    if separate or len(place) <= SEPARATE:
        return ranks
    return ranks * int(np.clip(len(ranks) // EACH, *BINS)) // len(place)


def _comparable(value: object) -> tuple[str, object]:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return "", float(value)
    return type(value).__name__, str(value)


@dataclass(frozen=True)
class Explained:
    """Shares of the variance that a setting alone explains; None where nothing does."""

    departure: float | None  # of the order of magnitude of departures
    falls: float | None  # of whether the walk is lost


@dataclass(frozen=True)
class Findings:
    """Points in each class, and how much every setting alone explains."""

    points: int
    prediction: str  # that departures are from
    classes: Mapping[str, int]
    explained: Mapping[str, Explained]
    reasons: Mapping[str, int]  # points without numbers, most frequent reasons first
    verdicts: Mapping[str, int]  # walks by what became of them
    method: str  # what the shares are that settings explain, and how exact
    together: Explained  # shares left over for settings together, where exact
    judge: str  # prediction that verdicts are by, if it is another one
    left_out: int = 0  # walks for which the prediction could not be made
    asked: int = 0  # points of the whole sweep, if known

    @property
    def ranked(self) -> list[tuple[str, Explained]]:
        """Settings, the weightiest first, and what only several together explain."""
        ranked = sorted(self.explained.items(), key=lambda of: -(of[1].departure or 0))
        known = self.together != Explained(None, None)
        rest = [("several together", self.together)] * known
        return [*ranked, *rest]

    def __str__(self) -> str:
        return render("study.txt", found=self, label=PREDICTIONS[self.prediction].label)


def _left(shares: Sequence[float | None]) -> float | None:
    """What is left of a whole by shares; None if one of them is unknown."""
    known = [share for share in shares if share is not None]
    return max(1.0 - sum(known), 0.0) if 1 < len(known) == len(shares) else None


def findings(results: Results) -> Findings:
    """What the table of a sweep says."""
    lost = (results.classes >= FELL).astype(float)
    off = np.log10(np.maximum(results.off, 1e-9))  # of the path; less is rounding
    off[results.classes >= FELL] = np.nan
    columns = [(key, results.columns[key]) for key in results.keys]
    places = [group(values, separate=True).tolist() for _, values in columns]
    rows, every = set(zip(*places, strict=True)), prod(len(set(p)) for p in places)
    grid = len(results) == len(rows) == every  # all combinations, each of them once
    whole = (known := int(np.isfinite(off).sum())) == len(results) and grid
    words, values = results.columns["verdict"], results.asked.get("vary", {}).values()
    asked = prod(len(v) for v in values if isinstance(v, list))
    grown = "these" if asked > len(results) else "this full grid of"
    how = f"exact for {grown}" if whole else "estimated from"
    method = message("variances" if columns[1:] else "alone", how=f"{how} {known}")
    alone = {
        key: Explained(explained(values, off, whole), explained(values, lost, grid))
        for key, values in columns
    }
    whys = (NUMBER.sub("...", str(s)) for s in results.columns["status"] if s != "ok")
    return Findings(
        points=len(results),
        prediction=results.prediction,
        classes=results.counts,
        explained=alone,
        reasons=dict(Counter(whys).most_common(5)),
        verdicts={"arrived": 0, **Counter(str(word) for word in words if word)},
        method="; ".join([method, *results.notes]),
        together=Explained(
            _left([one.departure for one in alone.values()]) if whole else None,
            _left([one.falls for one in alone.values()]) if grid else None,
        ),
        judge="" if results.judge == results.prediction else results.judge,
        left_out=results.left_out,
        asked=asked,
    )
