"""`stratawalk study`: where predictions hold in a sweep, and which settings matter."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

from sim.commands.options import needs_extra, option, report
from sim.scenarios.predictions import LABELS, prediction_key

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
        metavar="DIR",
        help="for the maps; `maps` beside the table if not given",
    ),
)


@needs_extra("sweep")
def execute(options: argparse.Namespace) -> None:
    """Print what a sweep has found, and draw its maps."""
    from sim.folder import blamed_on, ensure_folder
    from sim.progress import bar, stage
    from sim.studies.maps import draw_maps
    from sim.studies.results import findings, read_results

    given = Path(options.table)
    results = read_results(given, prediction_key(options.prediction))
    beside = (given if given.is_dir() else given.parent) / "maps"
    folder = ensure_folder(beside if options.out is None else Path(options.out))
    with (
        bar(quiet=options.json) as progress,
        stage(progress, "drawing maps"),
        blamed_on(given, "give the table that a sweep has written"),
    ):
        found, drawn = findings(results), draw_maps(results, folder)
    facts = asdict(found) | {"maps": [str(path) for path in drawn]}
    report(options, facts, found, *(f"{'map':8}{path}" for path in drawn))
