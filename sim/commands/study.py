"""`stratawalk study`: where predictions hold in a sweep, and which settings matter."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

from sim.commands.options import needs_extra, option, report
from sim.scenarios.predictions import LABELS, prediction_key

PAGES = (".html", ".htm")
HELP = "map where the predictions of a sweep hold, and tell which settings matter"
OPTIONS = (
    option("table", metavar="TABLE", help="table of a sweep, or the sweep's folder"),
    option(
        "--prediction",
        choices=LABELS,
        default="quasi-static",
        help="prediction that the walks are compared with",
    ),
    option(
        "--out",
        metavar="DIR|FILE.html",
        help="folder for the maps, or a page with maps, worst and best walks; `maps` "
        "beside the table if not given",
    ),
)


@needs_extra("sweep")
def execute(options: argparse.Namespace) -> None:
    """Print what a sweep has found, and draw its maps."""
    from sim.folder import RunFolder, blamed_on, ensure_folder
    from sim.progress import bar, stage
    from sim.studies.maps import draw_maps
    from sim.studies.page import page
    from sim.studies.results import findings, read_results

    given = Path(options.table)
    results = read_results(given, prediction_key(options.prediction))
    beside = (given if given.is_dir() else given.parent) / "maps"
    out = beside if options.out is None else Path(options.out)
    paged = out.suffix in PAGES
    folder = ensure_folder(out.parent if paged else out)
    with (
        bar(quiet=options.json) as progress,
        stage(progress, "drawing maps"),
        blamed_on(given, "give the table that a sweep has written"),
    ):
        results = results.fitted() if paged else results
        found = findings(results)
        if paged:
            RunFolder(folder).write_text(out.name, page(results, found, given, folder))
            made: dict[str, object] = {"page": str(out)}
            lines = [f"{'page':8}{out}"]
        else:
            drawn = draw_maps(results, folder)
            made = {"maps": [str(path) for path in drawn]}
            lines = [f"{'map':8}{path}" for path in drawn]
    report(options, asdict(found) | made, found, *lines)
