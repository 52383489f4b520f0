"""The page of one run, `report.html`: self-contained, for any screen and for print.

It shows the film of its folder, whichever there is when it is opened, and the control
sequence in the paper's notation: a flow along the field g for a time t as eq. (14) has
it, the time above and the field below, and strata named after the groups that stand.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from itertools import chain, groupby
from pathlib import Path

import numpy as np
from markupsafe import Markup

from planner import Array
from sim.evaluation.flows import WalkedPhase
from sim.evaluation.quantities import MINUS
from sim.folder import RunFolder
from sim.pictures.clock import FRAME_RATE, clock
from sim.progress import Progress, silent
from sim.reports import tables
from sim.reports.drawing import Drawing
from sim.reports.maps import errors, plan_view
from sim.reports.panels import panels
from sim.templates import render
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

NAME = "report.html"
MOMENTS = 1500  # at most under the cursor
DRAWINGS = 9  # at most, those of a walk among obstacles
FIELD = re.compile(r"g(\w+)_(\w+)")
DOING = {
    "hold": "standing still",
    "lift": "group {} lifts off",
    "swing": "group {} swings",
    "land": "group {} touches down",
}


def write_report(run: Run, progress: Progress = silent) -> Path:
    """Draw the report of a run into its folder, and give its path."""
    RunFolder(run.folder).write_text(NAME, page(run, progress))
    return run.folder / NAME


def page(run: Run, progress: Progress = silent) -> str:
    """The page as HTML."""
    plan, along, across, *over_time = _drawn(run, progress)
    return render(
        "report.html",
        title=f"{run.title}: {run.summary.verdict}",
        run=run,
        summary=run.summary,
        word=run.summary.verdict,
        sentences=tables.sentences(run),
        ends=tables.ends(run),
        maps=[plan, along, across],
        panels=over_time,
        sources=tables.sources(run),
        counts=tables.counts(run),
        sequence=list(_sequence(run)),
        settings=tables.settings(run),
        versions=tables.versions(run),
        moments=as_script(_moments(run)),
    )


def _drawn(run: Run, progress: Progress) -> Iterator[Drawing]:
    """All drawings of the page, in its order."""
    progress("report", 0.0)
    drawings = chain(map(plan_view, [run]), errors(run), panels(run))
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
    last, film = len(run.time) - 1, clock(run.time, run.settings.get("playback"))
    rows = np.unique(np.linspace(0, last, min(MOMENTS, last + 1)).astype(int))
    return {
        "time": np.round(run.time[rows], 3).tolist(),
        "x": _finite(1e3 * run.achieved[rows, 0], 2),
        "y": _finite(1e3 * run.achieved[rows, 1], 2),
        "off": _finite(1e3 * np.hypot(*run.error(run.best)[rows, :2].T), 3),
        "margin": _finite(1e3 * run.margin[rows], 1),
        "phase": np.clip(run.phase[rows], 0, len(run.phases) - 1).tolist(),
        "phases": [
            f"stratum {p.stratum}, {DOING.get(p.kind, p.kind).format(p.group)}"
            for p in run.phases
        ],
        "best": PREDICTIONS[run.best].label,
        "playback": film.playback,
        "begins": float(run.time[0]) - film.title * film.playback / FRAME_RATE,
    }


def _finite(values: Array, digits: int) -> list[float | None]:
    """Rounded numbers; None for what JSON has no number for."""
    return [round(float(v), digits) if np.isfinite(v) else None for v in values]


def _sequence(run: Run) -> Iterator[tuple[int, Markup]]:
    """Number of each segment, from 1, and its flows in the order of time."""
    last = ""
    for segment, phases in groupby(run.phases, key=lambda phase: phase.segment):
        text = Markup("")
        for phase in phases:
            stratum = phase.stratum
            if phase.kind == "land":  # that of all who stand once it is over
                pair = phase.stratum, phase.group
                stratum = "".join(g for g in run.groups if any(g in s for s in pair))
            if stratum != last:
                text += Markup(" &rarr; " if last else "") + _subscript("S", stratum)
                last = stratum
            if phase.kind == "swing":
                text += Markup(" ") + _flow(phase)
        yield segment + 1, text


def _flow(phase: WalkedPhase) -> Markup:
    amount = f"{phase.amount:.4g}".replace("-", MINUS)
    name = Markup.escape(phase.field)
    if found := FIELD.fullmatch(phase.field):  # the second of stratum 12, say
        name = _subscript("g", f"{found[1]},{found[2]}")
    text = "<span class=flow>&phi;<span><sup>{}</sup><sub>{}</sub></span></span>"
    return Markup(text).format(amount, name)


def _subscript(letter: str, index: str) -> Markup:
    return Markup("{}<sub>{}</sub>").format(letter, index)
