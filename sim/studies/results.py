"""A sweep's table, read back, and every point sorted by how well its prediction holds.

A point is judged by the farthest that the walk came from a prediction, as a share of
its path.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from planner import Array
from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.predictions import PREDICTIONS
from sim.sweeps.folder import SIDE_BY_SIDE, SweepFolder
from sim.sweeps.table import read_table

LIMITS = (0.01, 0.03, 0.10)
"""Shares of the path within which predictions hold."""
CLASSES = ("within 1 %", "within 3 %", "within 10 %", "beyond", "fell", "no walk")
BEYOND, FELL, NO_WALK = 3, 4, 5


@dataclass(frozen=True)
class Results:
    """The rows of a sweep's table."""

    columns: Mapping[str, list[object]]  # values by column, a list of one a row
    keys: tuple[str, ...]  # columns that vary
    prediction: str  # name of the prediction that points are judged by

    def __len__(self) -> int:
        return len(self.columns["point"])

    @cached_property
    def walked(self) -> Array:
        """Which points have numbers, shape (N,), bool."""
        return np.array([status == "ok" for status in self.columns["status"]])

    @cached_property
    def off(self) -> Array:
        """Farthest from the prediction as a share of the path, (N,); NaN for none."""
        farthest = self.column(f"error.{self.prediction}.farthest")
        length = self.column("path_length")
        walked = self.column("distance_walked")
        return farthest / np.where(length > 0, length, walked)

    @cached_property
    def classes(self) -> Array:
        """Index of each point's class among `CLASSES`, shape (N,)."""
        found = np.searchsorted(LIMITS, np.nan_to_num(self.off, nan=np.inf))
        words = self.columns.get("verdict", [None] * len(self))
        fell = np.array([word == "fell" for word in words])
        return np.where(self.walked, np.where(fell, FELL, found), NO_WALK)

    @property
    def counts(self) -> dict[str, int]:
        """Number of points in each class."""
        counted: Array = np.bincount(self.classes, minlength=len(CLASSES))
        return dict(zip(CLASSES, counted.tolist(), strict=True))

    @property
    def label(self) -> str:
        """Name of the prediction in words."""
        return PREDICTIONS[self.prediction].label

    def column(self, name: str) -> Array:
        """A column of numbers, shape (N,); NaN where a row has none."""
        if name not in self.columns:
            near = did_you_mean(name, self.columns)
            raise UsageError(f"no column {name!r}", "the table", near)
        given = self.columns[name]
        if any(isinstance(value, str) for value in given):
            raise UsageError(f"words in column {name!r}", "the table", "give numbers")
        return np.array([np.nan if value is None else value for value in given], float)


def read_results(path: Path, prediction: str) -> Results:
    """Read a table, or that of a sweep's folder; it must have the prediction."""
    file = SweepFolder(path).table if path.is_dir() else path
    columns, about = read_table(file)
    asked = about.get("asked") if isinstance(about, dict) else None
    vary = asked.get("vary") if isinstance(asked, dict) else None
    keys = tuple(key for names in vary or () for key in names.split(SIDE_BY_SIDE))
    strange = [key for key in keys if "/" in key or not key.isprintable()]
    lacking = [key for key in (*keys, "point", "status") if key not in columns]
    if vary is None or strange or lacking:
        what = f"it does not say what varies, {', '.join(strange + lacking)}"
        raise UsageError(what, str(file), "give the table that a sweep has written")
    results = Results(columns, keys, prediction)
    if results.walked.any():
        results.column(f"error.{prediction}.farthest")
    return results
