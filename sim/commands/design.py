"""`stratawalk design`: how few joints suffice, the paper's own question."""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

from sim.commands.options import (
    needs_extra,
    option,
    report,
    robot_of,
    robot_options,
    whole,
)
from sim.errors import UsageError

HELP = "how few joints suffice: swings locked or coupled, legs lifted in groups"
OPTIONS = (
    *robot_options("a shipped robot, or MJCF with a card"),
    option(
        "--walks",
        type=whole(0),
        default=20,
        metavar="N",
        help="how many designs to walk, the fewest joints first; 20 if not given",
    ),
    option("--designs", type=whole(1), metavar="N", help="look at the first N alone"),
    option("--out", metavar="FILE", help="Parquet table of all designs"),
)


@needs_extra("sweep")
def execute(options: argparse.Namespace) -> None:
    """Check every design, walk those that go everywhere, and print the table."""
    from sim.progress import bar
    from sim.studies.designing import designs, tried
    from sim.sweeps.identity import software
    from sim.sweeps.table import write_table

    robot = robot_of(options, options.robot)
    found = list(islice(designs(robot.legs), options.designs))
    if not found:
        what = (
            f"{len(robot.legs)} legs make no two groups of which each carries the body "
            "while the other is lifted"
        )
        remedy = "take six legs or more; `stratawalk check` judges fewer as they are"
        raise UsageError(what, options.robot, remedy)
    rows = []
    with bar(quiet=options.json) as progress:
        for row in tried(robot, found, options.walks):
            rows.append(row)
            progress("designs", len(rows) / len(found))
    if options.out is not None:
        about = {"robot": options.robot, "software": software()}
        write_table(Path(options.out), rows, about)
    report(options, rows, *_table(rows))


def _table(rows: list[Mapping[str, Any]]) -> Iterator[str]:
    """By the number of joints: designs, where they go, and the best that walked."""
    from sim.studies.designing import DIRECTIONS

    by_joints = defaultdict(list)
    for row in rows:
        by_joints[row["joints"]].append(row)
    yield (
        f"{'joints':>6}{'designs':>9}{'ahead':>7}{'aside':>7}{'round':>7}{'all':>6}"
        f"{'walked':>8}{'strokes/m':>11}{'margin':>9}{'off':>8}  best design"
    )
    for joints, some in sorted(by_joints.items()):
        walked = [row for row in some if row.get("min_margin") is not None]
        ways = [sum(row[f"goes.{way}"] for row in some) for way in DIRECTIONS]
        able = sum(all(row[f"goes.{way}"] for way in DIRECTIONS) for row in some)
        line = (
            f"{joints:6}{len(some):9}{ways[0]:7}{ways[1]:7}{ways[2]:7}{able:6}"
            f"{len(walked):8}"
        )
        if walked:
            best = min(walked, key=lambda row: row["strokes_per_metre"])
            line += (
                f"{best['strokes_per_metre']:11.1f}{1e3 * best['min_margin']:6.1f} mm"
                f"{best['farthest_per_path']:8.1%}  {best['groups']}"
            )
        yield line
