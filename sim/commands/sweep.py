"""`stratawalk sweep`: one scenario walked with many settings, into one table."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import needs_extra, notice, option, report, whole
from sim.endings import again, keeping
from sim.errors import ExitCode, UsageError

if TYPE_CHECKING:
    from sim.sweeps.folder import Shard
    from sim.sweeps.sweeping import Result

HELP = "walk a scenario with many settings, into one table; what is done is never lost"
PRINTED = 5  # reasons of failed points, at most
MOST_WORKERS = 256  # more are for a cluster, with a scheduler


def _shard(text: str) -> Shard:
    from sim.sweeps.folder import Shard

    number, _, count = text.partition("/")
    if not (number.isdecimal() and count.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text} is not I/N; give 1/4, say")
    try:
        return Shard(int(number), int(count))
    except UsageError as error:  # which argparse would take for a ValueError of its own
        raise argparse.ArgumentTypeError(f"{error.what}; {error.remedy}") from error


OPTIONS = (
    option(
        "file",
        metavar="FILE.toml",
        help="which scenario, what varies; or a shipped study",
    ),
    option(
        "--out", metavar="DIR", required=True, help="folder of the sweep, to be made"
    ),
    option(
        "--resume",
        action="store_true",
        help="walk only what is not done yet; begin if there is nothing",
    ),
    option(
        "--force-mix",
        action="store_true",
        help="keep points in a table although sweep or versions have changed",
    ),
    option(
        "--workers",
        type=whole(1, MOST_WORKERS),
        metavar="N",
        help="processes on this machine; one a core if not given",
    ),
    option(
        "--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers to take"
    ),
    option(
        "--shard",
        type=_shard,
        metavar="I/N",
        help="walk the I-th of N equal parts alone, I from 1; `merge` joins them",
    ),
)


@needs_extra("sweep")
def execute(options: argparse.Namespace) -> ExitCode:
    """Walk what is not done yet, write the table, and say what failed."""
    from sim.progress import bar
    from sim.sweeps.file import read_sweep
    from sim.sweeps.folder import Shard, claim
    from sim.sweeps.sweeping import carry_on, points_of, write_run_folders

    sweep = read_sweep(options.file)
    shard = options.shard or Shard()
    workers, scheduler = _workers(options), options.scheduler
    points = points_of(sweep, shard)
    folder = claim(Path(options.out), shard, options.resume)
    far, first = "points that are done", None

    def kept() -> str:
        on = again(*([] if options.resume else ["--resume"]))
        return f"{far} are kept in {options.out}, go on: {on}"

    with bar(quiet=options.json) as progress, keeping(kept):

        def show(done: int, failed: int, count: int) -> None:
            nonlocal far, first
            far = f"{done} of {count} points are done, they"
            first = done if first is None else first  # which count for no pace
            about = f"points, {done} of {count} done, {failed} failed"
            progress(about, (done - first) / max(count - first, 1))

        result = carry_on(
            points, folder, workers, scheduler, mix=options.force_mix, show=show
        )
        for line in write_run_folders(points, folder):
            notice(f"no run folder, {line}", "warning")
    return print_result(options, result, folder.table)


def _workers(options: argparse.Namespace) -> int:
    if options.workers is None:
        return len(os.sched_getaffinity(0))
    if options.scheduler is not None:
        what = "a scheduler has workers of its own"
        raise UsageError(what, "--workers and --scheduler", "keep one of them")
    return int(options.workers)


def print_result(options: argparse.Namespace, result: Result, table: Path) -> ExitCode:
    """Say what became of a sweep; the code that it ends with."""
    counts = {key: getattr(result, key) for key in ("points", "failed", "walked")}
    reasons = dict(result.reasons)
    shown = list(reasons.items())[:PRINTED]
    report(
        options,
        {**counts, "reasons": reasons, "table": str(table)},
        f"{result.points} points, {result.walked} walked now, {result.failed} failed",
        *(f"{count:6}  {reason}" for reason, count in shown),
        f"{'table':8}{table}",
    )
    if result.failed and not options.json:
        line = f"{result.failed} of {result.points} points failed"
        where = f"{table}; the column status says why"
        notice(f"{line}: {where}", "error")
    return ExitCode.SWEEP if result.failed else ExitCode.OK
