"""Several runs side by side: their differing settings and their results."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat

import numpy as np

from sim.evaluation.quantities import (
    ACHIEVED,
    GOAL,
    NONE,
    OF_ROWS,
    OF_WALKS,
    POSITION,
    YAW,
    number,
)
from sim.progress import Progress, silent, stage
from sim.reports.drawing import MM
from sim.reports.maps import best_of, overlaid
from sim.reports.tables import Table, contributions, flat, kinds_of, sentences
from sim.runs.run import Run
from sim.scenarios.file import toml_value
from sim.scenarios.predictions import IDEAL, PREDICTIONS
from sim.templates import render

FINER = 1  # digits, by which errors of several runs are told apart
IGNORED = ("name", "description")
PLAYED = ("robot/", "motion.csv")  # beginnings of names of files that are walked


@dataclass(frozen=True)
class Comparison:
    """Runs, and the tables that compare them; a column a run."""

    runs: Sequence[Run]
    differences: Table  # settings that are not the same in all runs
    results: Table
    drift: Table  # what kinds of phases contribute to the way off the ideal prediction
    left: Table  # and to that off the best prediction
    same: Table  # settings that are the same in all


def compare(runs: Sequence[Run]) -> Comparison:
    """Compare the runs of several folders."""
    settings = [{k: toml_value(v) for k, v in flat(run.settings)} for run in runs]
    keys = (k for k in dict.fromkeys(chain(*settings)) if k not in IGNORED)
    rows = [(k, *(s.get(k, "not set") for s in settings)) for k in keys]
    same = [row[:2] for row in rows if len(set(row[1:])) == 1]
    seals = [run.summary.seals or {} for run in runs]  # of the robot's files, too
    files = (k for k in seals[0] if k.startswith(PLAYED) and all(k in s for s in seals))
    rows += [(k, *(f"sealed {s[k]}" for s in seals)) for k in files]
    differing = [row for row in rows if len(set(row[1:])) > 1]
    return Comparison(
        runs,
        differences=Table(("setting", *names(runs)), differing),
        results=Table(("", *names(runs)), list(_results(runs))),
        drift=_drift(runs, IDEAL.key),
        left=_drift(runs),
        same=Table(("setting", "value in all runs"), same),
    )


def page(compared: Comparison, progress: Progress = silent) -> str:
    """The page of a comparison as HTML."""
    runs = list(zip(names(compared.runs), compared.runs, strict=True))
    with stage(progress, "drawing paths"):
        maps = list(overlaid(runs))
    return render(
        "compare.html",
        title=f"{len(runs)} runs compared",
        compared=compared,
        runs=[(name, run.summary.verdict, sentences(run)) for name, run in runs],
        maps=maps,
    )


def names(runs: Sequence[Run]) -> list[str]:
    """Names of the runs: their folders, with more of the path where two are alike."""
    folders, last = [run.folder.parts for run in runs], 1
    while len({parts[-last:] for parts in folders}) < len({*folders}):
        last += 1
    return ["/".join(parts[-last:]).lstrip("/") for parts in folders]


def _results(runs: Sequence[Run]) -> Iterator[tuple[str, ...]]:
    """What came of the runs: a row a quantity, with a digit more for what differs."""
    summaries = [run.summary for run in runs]
    yield "verdict", *(summary.verdict for summary in summaries)
    yield "robot", *(summary.robot for summary in summaries)
    for q, label in ((POSITION, "off the goal"), (YAW, "off the goal in yaw")):
        yield f"{label} [{q.unit}]", *(q.cell(s, GOAL, FINER) for s in summaries)
    ends = ((POSITION.value(s, GOAL), s.path_length) for s in summaries)
    shares = (None if off is None or not way else 100 * off / way for off, way in ends)
    yield "off the goal [% of the path]", *(number(share, 3) for share in shares)
    for key, name in PREDICTIONS.items():
        for q in (POSITION, *(q for q in OF_ROWS if q.key.startswith("error"))):
            cells = (q.cell(s, key, FINER) for s in summaries)
            yield f"off {name.label}, {q.title}", *cells
    for q in (q for q in OF_ROWS if not q.key.startswith("error")):
        yield q.title, *(q.cell(s, ACHIEVED) for s in summaries)
    for q in (q for q in OF_WALKS if any(q.value(s) is not None for s in summaries)):
        yield q.title, *(q.cell(s) for s in summaries)


def _drift(runs: Sequence[Run], prediction: str = "") -> Table:
    """Millimetres that kinds of phases add to the way off a prediction, or the best.

    They count along the way off the ideal one, if there is one, so that they add up.
    """
    parts: list[dict[str, str]] = []
    for run in runs:
        found = contributions(run)
        ideal, own = (found.get(k, {}) for k in (IDEAL.key, prediction or run.best))
        away = sum((ideal or own).values(), np.zeros(3))[:2]
        along = away / (float(np.hypot(*away)) or 1.0)
        added = {label: MM * float(part[:2] @ along) for label, part in own.items()}
        sums = ((name, sum(added[k] for k in of)) for name, of in kinds_of(own))
        parts.append({name: number(length, 2) for name, length in sums})
    what = "the ideal prediction" if prediction else best_of(runs)
    kinds = dict.fromkeys(chain(*parts))
    blank = ["replanned" if run.summary.replan else NONE for run in runs]
    rows = [(k, *map(dict.get, parts, repeat(k), blank)) for k in kinds]
    return Table((f"off {what}, by phase [mm]", *names(runs)), rows)
