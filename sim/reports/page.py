"""The page of one run, `report.html`: self-contained, for any screen and for print.

It shows the film of its folder, whichever there is when it is opened, and the control
sequence in the paper's notation: a flow along the field g for a time t as eq. (14) has
it, the time above and the field below, and strata named after the groups that stand.
"""

from collections.abc import Iterator
from itertools import chain, groupby
from pathlib import Path

import numpy as np

from planner import Array
from sim.evaluation.flows import WalkedPhase
from sim.folder import RunFolder
from sim.pictures.clock import FRAME_RATE, clock
from sim.progress import Progress, silent
from sim.reports import tables
from sim.reports.drawing import WORDS, Drawing
from sim.reports.maps import errors, plan_view
from sim.reports.panels import panels
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS
from sim.templates import render

NAME = "report.html"
MOMENTS = 1500  # at most under the cursor


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
        sequence=[] if run.settings.get("motion") else list(_sequence(run)),
        settings=tables.settings(run),
        versions=tables.versions(run),
        moments=_moments(run),
    )


def _drawn(run: Run, progress: Progress) -> Iterator[Drawing]:
    """All drawings of the page, in its order."""
    progress("report", 0.0)
    drawings = chain(map(plan_view, [run]), errors(run), panels(run))
    for number, drawing in enumerate(drawings, start=1):
        progress("report", min(number / 9, 1.0))  # 9 among obstacles
        yield drawing
    progress("report", 1.0)


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
        "phase": run.phase[rows].tolist(),
        "phases": [
            f"stratum {p.stratum}, {WORDS['doing'].get(p.kind, p.kind).format(p.group)}"
            for p in run.phases
        ],
        "best": PREDICTIONS[run.best].label,
        "playback": film.playback,
        "begins": float(run.time[0]) - film.title * film.playback / FRAME_RATE,
    }


def _finite(values: Array, digits: int) -> list[float | None]:
    """Rounded numbers; None for what JSON has no number for."""
    return [round(float(v), digits) if np.isfinite(v) else None for v in values]


def _sequence(run: Run) -> Iterator[tuple[int, list[tuple[str, WalkedPhase]]]]:
    """Number of each segment, from 1, and its phases, with strata that are new."""
    last, groups = "", run.card.groups
    for segment, phases in groupby(run.phases, key=lambda phase: phase.segment):
        steps = []
        for phase in phases:
            stratum = phase.stratum
            if phase.kind == "land":  # that of all who stand once it is over
                pair = phase.stratum, phase.group
                stratum = "".join(g for g in groups if any(g in s for s in pair))
            steps.append(("" if stratum == last else stratum, phase))
            last = stratum
        yield segment + 1, steps
