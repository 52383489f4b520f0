"""The page of one run, `report.html`: self-contained, for any screen and for print.

It shows the film of its folder, whichever there is when it is opened.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from markupsafe import Markup

from sim.folder import RunFolder, blamed_on
from sim.reports import tables, verdict
from sim.reports.maps import magnified, plan_view
from sim.reports.notation import sequence
from sim.reports.panels import panels
from sim.reports.present import moments
from sim.reports.record import Record, read_run
from sim.reports.templates import render

NAME = "report.html"


def write_report(folder: Path) -> Path:
    """Draw the report of a run into its folder.

    Args:
        folder: Of a run that came to its end.

    Returns:
        The report's path.

    Raises:
        UsageError: If it is not the folder of a finished run.
        FilesError: If the folder cannot be written.
    """
    with blamed_on(folder):
        text = page(read_run(folder))
    RunFolder(folder).write_text(NAME, text)
    return folder / NAME


def page(run: Record) -> str:
    """The page as HTML."""
    return render(
        "report.html",
        title=f"{run.title}: {verdict.word(run.summary)}",
        run=run,
        summary=run.summary,
        word=verdict.word(run.summary),
        sentences=verdict.sentences(run.summary),
        ends=tables.ends(run),
        maps=[plan_view(run), magnified(run)],
        panels=panels(run),
        sources=tables.sources(run),
        counts=tables.counts(run),
        sequence=list(sequence(run)),
        settings=tables.settings(run),
        versions=tables.versions(run),
        moments=as_script(moments(run)),
    )


def as_script(value: Any) -> Markup:
    """JSON that may stand inside a script element."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))
