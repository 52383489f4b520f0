"""The page of one run, `report.html`: self-contained, for any screen and for print.

It shows the film of its folder, whichever there is when it is opened.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from markupsafe import Markup

from sim.folder import RunFolder
from sim.progress import Progress, silent
from sim.reports import tables, verdict
from sim.reports.drawing import Drawing
from sim.reports.maps import magnified, plan_view
from sim.reports.notation import sequence
from sim.reports.panels import panels
from sim.reports.present import moments
from sim.reports.templates import render
from sim.runs.run import Run

NAME = "report.html"
DRAWINGS = 9  # at most, those of a walk among obstacles


def write_report(run: Run, progress: Progress = silent) -> Path:
    """Draw the report of a run into its folder.

    Args:
        run: A run that came to its end.
        progress: Called with the stage and the finished part of it.

    Returns:
        The report's path.

    Raises:
        FilesError: If the folder cannot be written.
    """
    RunFolder(run.folder).write_text(NAME, page(run, progress))
    return run.folder / NAME


def page(run: Run, progress: Progress = silent) -> str:
    """The page as HTML.

    Args:
        run: What it is about.
        progress: Called with the stage and the finished part of it.
    """
    plan, beside, *over_time = _drawn(run, progress)
    return render(
        "report.html",
        title=f"{run.title}: {verdict.word(run.summary)}",
        run=run,
        summary=run.summary,
        word=verdict.word(run.summary),
        sentences=verdict.sentences(run.summary),
        ends=tables.ends(run),
        maps=[plan, beside],
        panels=over_time,
        sources=tables.sources(run),
        counts=tables.counts(run),
        sequence=list(sequence(run)),
        settings=tables.settings(run),
        versions=tables.versions(run),
        moments=as_script(moments(run)),
    )


def _drawn(run: Run, progress: Progress) -> Iterator[Drawing]:
    """All drawings of the page, in its order."""
    progress("report", 0.0)
    drawings = chain((draw(run) for draw in (plan_view, magnified)), panels(run))
    for number, drawing in enumerate(drawings, start=1):
        progress("report", min(number / DRAWINGS, 1.0))
        yield drawing
    progress("report", 1.0)


def as_script(value: Any) -> Markup:
    """JSON that may stand inside a script element."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))
