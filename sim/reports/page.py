"""The page of one run, `report.html`: self-contained, for any screen and for print.

It shows the film of its folder, whichever there is when it is opened.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from markupsafe import Markup

from planner import Array
from sim.folder import RunFolder
from sim.pictures.clock import clock
from sim.progress import Progress, silent
from sim.reports import tables
from sim.reports.drawing import Drawing
from sim.reports.maps import magnified, plan_view
from sim.reports.notation import sequence
from sim.reports.panels import panels
from sim.reports.templates import render
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

NAME = "report.html"
MOMENTS = 1500  # at most under the cursor
DRAWINGS = 9  # at most, those of a walk among obstacles


def write_report(run: Run, progress: Progress = silent) -> Path:
    """Draw the report of a run into its folder, and give its path."""
    RunFolder(run.folder).write_text(NAME, page(run, progress))
    return run.folder / NAME


def page(run: Run, progress: Progress = silent) -> str:
    """The page as HTML."""
    plan, beside, *over_time = _drawn(run, progress)
    return render(
        "report.html",
        title=f"{run.title}: {tables.word(run)}",
        run=run,
        summary=run.summary,
        word=tables.word(run),
        sentences=tables.sentences(run),
        ends=tables.ends(run),
        maps=[plan, beside],
        panels=over_time,
        sources=tables.sources(run),
        counts=tables.counts(run),
        sequence=list(sequence(run)),
        settings=tables.settings(run),
        versions=tables.versions(run),
        moments=as_script(_moments(run)),
    )


def _drawn(run: Run, progress: Progress) -> Iterator[Drawing]:
    """All drawings of the page, in its order."""
    progress("report", 0.0)
    drawings = chain((draw(run) for draw in (plan_view, magnified)), panels(run))
    for number, drawing in enumerate(drawings, start=1):
        progress("report", min(number / DRAWINGS, 1.0))
        yield drawing
    progress("report", 1.0)


def as_script(value: object) -> Markup:
    """JSON that may stand inside a script element."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))


def _moments(run: Run) -> dict[str, object]:
    """Poses, distances and margins at moments evenly spread, for the script."""
    last = len(run.time) - 1
    rows = np.unique(np.linspace(0, last, min(MOMENTS, last + 1)).astype(int))
    off = 1e3 * np.hypot(*run.error(run.best)[rows, :2].T)
    phase = np.clip(run.phase[rows], 0, len(run.phases) - 1)
    margin = 1e3 * run.margin[rows]
    return {
        "time": np.round(run.time[rows], 3).tolist(),
        "x": _finite(1e3 * run.achieved[rows, 0], 2),
        "y": _finite(1e3 * run.achieved[rows, 1], 2),
        "off": _finite(off, 3),
        "margin": _finite(margin, 1),
        "phase": phase.tolist(),
        "phases": [_doing(p.kind, p.stratum, p.group) for p in run.phases],
        "best": PREDICTIONS[run.best].label,
        "playback": clock(run.time, run.settings.get("playback")).playback,
        "begins": float(run.time[0]),
    }


def _finite(values: Array, digits: int) -> list[float | None]:
    """Rounded numbers; None for what JSON has no number for."""
    return [round(float(v), digits) if np.isfinite(v) else None for v in values]


def _doing(kind: str, stratum: str, group: str) -> str:
    what = {
        "hold": "standing still",
        "lift": f"group {group} lifts off",
        "swing": f"group {group} swings",
        "land": f"group {group} touches down",
    }
    return f"stratum {stratum}, {what.get(kind, kind)}"
