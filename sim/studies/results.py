"""A sweep's table, read back: how far each of its walks came from a prediction.

A point is judged by the farthest that the walk came from it, as a share of its path.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import compress
from pathlib import Path
from types import NoneType
from typing import Any, get_args

import numpy as np

from planner import Array
from planner.support import did_you_mean
from sim.errors import UsageError, message
from sim.evaluation.verdict import Word
from sim.scenarios.declaration import refusal
from sim.scenarios.predictions import PREDICTIONS
from sim.sweeps.file import MOST_KEYS
from sim.sweeps.folder import SIDE_BY_SIDE, SweepFolder
from sim.sweeps.table import read_table

KEY = re.compile(r"[\w.]{1,60}", re.ASCII)  # of a setting, in names of files, too
LIMITS = (0.01, 0.03, 0.10)  # shares of the path within which predictions hold
MOST = 1e12  # in any number of a table
MOST_GIVEN = 3 * 10**6  # values of settings that vary, which take half a minute
SHORTEST = 1e-9  # way that a walk can be off by a share of [m]
FURTHER = ("beyond", "fell", "no walk")  # classes, after those of the limits
FELL, NO_WALK = 4, 5
JUDGE = "weighed.prediction"  # column of what verdicts are by
UNJUDGED = "quasi_static"  # what walks of a table without verdicts are compared with
THIRDS = (1 / 3, 2 / 3, 1.0)  # of the points, above which the fitted limits are
STEPS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
ROUND = np.outer(10.0 ** np.arange(-9, 4), STEPS).ravel()


@dataclass(frozen=True)
class Results:
    """The rows of a sweep's table."""

    columns: Mapping[str, list[object]]  # values by column, a list of one a row
    keys: tuple[str, ...]  # columns that vary
    prediction: str  # name of the prediction that points are judged by
    asked: Mapping[str, Any] = field(default_factory=dict)  # what the sweep is about
    limits: tuple[float, ...] = LIMITS  # of the classes, shares of the path
    judge: str = ""  # name of the prediction that verdicts are by, if known
    left_out: int = 0  # walks for which the prediction could not be made
    mixed: bool = False  # whether points of other software may be among them

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
        path, walked = map(self.column, ("path_length", "distance_walked"))
        return farthest / np.maximum(np.where(path > SHORTEST, path, walked), SHORTEST)

    @cached_property
    def classes(self) -> Array:
        """Index of each point's class, in the order of `counts`, shape (N,)."""
        found = np.searchsorted(self.limits, np.nan_to_num(self.off, nan=np.inf))
        fell = np.array([word == "fell" for word in self.columns["verdict"]])
        return np.where(self.walked, np.where(fell, FELL, found), NO_WALK)

    @property
    def counts(self) -> dict[str, int]:
        """Number of points in each class."""
        names = [*(f"within {100 * one:.9g} %" for one in self.limits), *FURTHER]
        counted: Array = np.bincount(self.classes, minlength=len(names))
        return dict(zip(names, counted.tolist(), strict=True))

    def predicted(self) -> "Results":
        """The same without walks for which the prediction could not be made."""
        kept = np.isfinite(self.off) | (self.classes >= FELL)
        columns = {k: [*compress(some, kept)] for k, some in self.columns.items()}
        return replace(self, columns=columns, left_out=int((~kept).sum()))

    def fitted(self) -> "Results":
        """The same with round limits above each third of those that walked."""
        off = self.off[self.classes < FELL]
        if not len(off):
            return self
        places = np.searchsorted(ROUND * (1 + 1e-9), np.quantile(off, THIRDS))
        places[1:] = np.maximum(places[1:], places[0] + (1, 2))  # one after another
        places[2] = max(places[2], places[1] + 1)
        limits = ROUND[np.minimum(places, len(ROUND) - np.array([3, 2, 1]))].tolist()
        return replace(self, limits=tuple(limits))

    @property
    def notes(self) -> list[str]:
        """What a reader should know of how its points were made."""
        cut = self.columns.get("hurried", []).count(True)
        return [message("from_others")] * self.mixed + [
            message("hurried", count=cut)
        ] * (cut > 0)

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
        _require(name, given, "numbers from 0", int, float, NoneType)
        return np.array([np.nan if value is None else value for value in given], float)


def read_results(path: Path, prediction: str = "") -> Results:
    """Read a table, or a sweep's; without a prediction, by that of most verdicts."""
    file = SweepFolder(path).table if path.is_dir() else path
    if path.suffix == ".toml" and path.is_file():
        raise UsageError("not swept yet", str(path), "give stratawalk sweep this file")
    columns, about = read_table(file)
    parts = given.items() if isinstance(given := about.get("asked"), dict) else ()
    asked = {name: part for name, part in parts if isinstance(part, dict)}
    known = asked.get("vary", {})
    keys = tuple(dict.fromkeys(k for names in known for k in names.split(SIDE_BY_SIDE)))
    strange = [key for key in keys if not KEY.fullmatch(key)]
    lacking = [key for key in (*keys, "point", "status") if key not in columns]
    if "vary" not in asked or strange or lacking:
        what = ", ".join(["it does not say what varies", *strange, *lacking])
        raise UsageError(what, str(file), "give the table that a sweep has written")
    if len(keys) > MOST_KEYS:
        raise UsageError.of("keys", file, count=len(keys), most=MOST_KEYS)
    if (given := len(keys) * len(columns["point"])) > MOST_GIVEN:
        raise UsageError.of("many_given", file, given=given, most=MOST_GIVEN)
    columns.setdefault("verdict", [None] * len(columns["point"]))
    _require("point", columns["point"], "whole numbers from 0", int)
    (point, times), *_ = Counter(columns["point"]).most_common(1) or [(0, 1)]
    if times > 1:
        raise UsageError.of("in_rows", file, point=point, times=times)
    _require("status", columns["status"], "texts in print", str)
    if odd := {*columns["verdict"]} - {None, *get_args(Word)}:
        raise refusal(min(odd, key=str), "a verdict", str(file), "verdict")
    for key in keys:
        _require(key, columns[key], "one value", bool, int, float, str, least=-MOST)
    judges = [name for name in columns.get(JUDGE, ()) if name]
    _require(JUDGE, judges, "texts", str)
    judge = str(Counter(judges).most_common(1)[0][0]) if judges else UNJUDGED
    if judge not in PREDICTIONS:
        raise refusal(judge, "a prediction", str(file), f"column {JUDGE!r}")
    told = columns, keys, prediction or judge, asked
    results = Results(*told, judge=judge, mixed=bool(about.get("mixed")))
    made = {p.label for k, p in PREDICTIONS.items() if f"error.{k}.farthest" in columns}
    if made and results.label not in made:
        facts = {"label": results.label, "made": " or ".join(sorted(made))}
        raise UsageError.of("not_compared", file, **facts)
    if not results.walked.any():
        why = [*columns["status"], "it has no rows"]
        raise UsageError.of("none_walked", file, why=why[0])
    found = results.predicted()
    if found.left_out and not found.walked.any():
        raise UsageError.of("none_predicted", file, label=results.label)
    return found


def _require(
    name: str, values: Sequence[object], wanted: str, *kinds: type, least: float = 0.0
) -> None:
    """Refuse a column with a value of another type, or a number out of bounds."""
    for row, value in enumerate(values):
        number = value if isinstance(value, int | float) else least
        odd = kinds == (str,) and not str(value).isprintable()  # a text of ours
        if odd or type(value) not in kinds or not least <= number <= MOST:
            wanted += f" to {MOST:g}" * (number > MOST)
            raise refusal(value, wanted, "the table", f"row {row} of column {name!r}")
