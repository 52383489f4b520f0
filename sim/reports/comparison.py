"""Several runs side by side: their differing settings and their results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sim.progress import Progress, silent
from sim.reports import verdict
from sim.reports.maps import magnified, plan_view
from sim.reports.tables import NONE, Table, flat, number
from sim.reports.templates import render
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

MM = 1e3
Summary = Mapping[str, Any]
IGNORED = ("name", "description")


@dataclass(frozen=True)
class Comparison:
    """Runs, and the tables that compare them; a column a run.

    Attributes:
        runs: What is compared.
        differences: Settings that are not the same in all runs.
        results: What came of the runs.
        same: Settings that are the same in all.
    """

    runs: Sequence[Run]
    differences: Table
    results: Table
    same: Table


def compare(runs: Sequence[Run]) -> Comparison:
    """Compare the runs of several folders."""
    settings = [dict(flat(run.settings)) for run in runs]
    keys = [
        k for k in dict.fromkeys(k for s in settings for k in s) if k not in IGNORED
    ]
    rows = {key: [_said(s.get(key)) for s in settings] for key in keys}
    header = ("setting", *names(runs))
    differing = [(key, *row) for key, row in rows.items() if len(set(row)) > 1]
    same = [(key, row[0]) for key, row in rows.items() if len(set(row)) == 1]
    results = [
        (label, *(_shown(run.summary, value) for run in runs))
        for label, value in RESULTS.items()
    ]
    return Comparison(
        runs,
        Table(header, differing),
        Table(("", *header[1:]), results),
        Table(("setting", "value in all runs"), same),
    )


def page(compared: Comparison, progress: Progress = silent) -> str:
    """The page of a comparison as HTML.

    Args:
        compared: What it shows.
        progress: Called with the stage and the finished part of it.
    """
    runs = list(zip(names(compared.runs), compared.runs, strict=True))
    maps = []
    for done, (name, run) in enumerate(runs, start=1):
        maps.append((name, (plan_view(run), magnified(run))))
        progress("drawing paths", done / len(runs))
    return render(
        "compare.html",
        title=f"{len(runs)} runs compared",
        compared=compared,
        runs=[
            (name, verdict.word(r.summary), verdict.sentences(r.summary))
            for name, r in runs
        ],
        maps=maps,
    )


def names(runs: Sequence[Run]) -> list[str]:
    """Names of the runs: their folders, with more of the path where two are alike."""
    short = [run.title for run in runs]
    if len(set(short)) == len(short):
        return short
    return [f"{run.folder.parent.name}/{run.title}" for run in runs]


def _said(value: object) -> str:
    return "not set" if value is None else str(value)


def _shown(summary: Summary, value: Callable[[Summary], object]) -> str:
    """A result; a dash where a run has none."""
    try:
        found = value(summary)
    except (KeyError, TypeError):
        return NONE
    return found if isinstance(found, str) else str(found)


def _off(name: str, key: str) -> Callable[[Summary], str]:
    return lambda summary: number(MM * summary["error"][name][key], 3)


RESULTS: Mapping[str, Callable[[Summary], object]] = {
    "verdict": verdict.word,
    "robot": lambda s: s["robot"],
    "off the goal [mm]": _off("goal", "position"),
    "off the goal in yaw [mrad]": _off("goal", "yaw"),
    **{
        f"off {said}, {what} [mm]": _off(name, key)
        for name, (_, said, _) in PREDICTIONS.items()
        for what, key in (("at the end", "position"), ("at most", "farthest"))
    },
    "least margin [mm]": lambda s: number(MM * s["achieved"]["min_margin"], 1),
    "slip [mm]": lambda s: number(MM * s["achieved"]["slip"], 1),
    "creep floor [mm]": lambda s: number(MM * s["achieved"]["creep_floor"], 3),
    "contact switches": lambda s: s["contact_switches"],
    "contact switches achieved": lambda s: s["contact_switches_achieved"],
    "bounces": lambda s: s["bounces"],
    "length of the path [mm]": lambda s: number(MM * s["path_length"], 1),
    "way walked [mm]": lambda s: number(MM * s["distance_walked"], 1),
    "simulated time [s]": lambda s: number(s["simulated_time"], 1),
}
"""What is compared, by its name in the table."""
