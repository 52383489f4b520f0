"""`stratawalk merge`: the shards of a sweep, joined to one table."""

from __future__ import annotations

import argparse
from pathlib import Path

from sim.commands.options import needs_extra, option
from sim.errors import ExitCode

HELP = "join what `sweep --shard` has walked to one table"
OPTIONS = (
    option("folders", metavar="DIR", nargs="+", help="folders of the sweep's shards"),
    option(
        "--out",
        metavar="DIR",
        help="where the table goes; the first folder if not given",
    ),
)


@needs_extra("sweep")
def execute(options: argparse.Namespace) -> ExitCode:
    """Write the table of all shards, and say what failed."""
    from sim.commands.sweep import print_result
    from sim.sweeps.sweeping import merge

    folders = [Path(folder) for folder in options.folders]
    out = folders[0] if options.out is None else Path(options.out)
    result, table = merge(folders, out)
    return print_result(options, result, table)
