"""Many walks in one table: sweeps and their shards, what they say, and designs."""

import argparse
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from itertools import groupby, islice
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from sim.commands import options as cli
from sim.endings import again, command, keeping
from sim.errors import ExitCode, UsageError, message
from sim.folder import blamed_on, ensure_folder, new_file, whole
from sim.progress import bar, say
from sim.scenarios.predictions import prediction_key
from sim.studies import maps
from sim.studies.designing import DIRECTIONS, count_designs, designs, tried
from sim.studies.findings import findings
from sim.studies.results import read_results
from sim.sweeps import sweeping
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import Shard, SweepFolder, claim
from sim.sweeps.ledger import software
from sim.sweeps.table import write_table
from sim.templates import render

ADDRESS = r"((tcp|tls|ws)://)?([^/:]+|\[[^/]+\]):([1-9]\d{0,3}|[1-5]\d{4}|6[0-5]\d{3})"
MOST_DESIGNS = 10**6  # some 7 hours; 8 legs have 144,088, 12 legs 259 million


def sweep(options: argparse.Namespace) -> ExitCode:
    """Walk what is not done yet, write the table, and say what failed."""
    asked = read_sweep(options.file)
    if options.out is None:
        raise UsageError.of("no_out", "stratawalk sweep", name=asked.name)
    shard = options.shard or Shard()
    workers, scheduler = options.workers, options.scheduler
    if workers and scheduler is not None:
        raise UsageError.of("own_workers", "--workers and --scheduler")
    if scheduler is not None and not re.fullmatch(ADDRESS, scheduler):
        raise UsageError("an address without a port", scheduler, "give tcp://HOST:PORT")
    workers = workers or len(os.sched_getaffinity(0))
    with cli.working(options, "checking points"):
        points = sweeping.points_of(asked, shard)
    paths: list[Any] = [table.get("path", {}) for table in points.tables.values()]
    yaws = (abs(path["goal"][2]) for path in paths if "goal" in path)
    cli.tell_radians("yaw", max(yaws, default=0.0))
    robots = {str(table["robot"]) for table in points.tables.values()}
    for path in map(Path, sorted(robots)):
        if path.is_file() and not path.with_suffix(".toml").exists():
            cli.notice(message("no_card", path=path))
    folder = claim(Path(options.out), shard, options.resume)
    far, first = "what is done is", None

    def kept() -> str:
        on = again(*([] if options.resume else ["--resume"]))
        there = folder.ledger.exists()
        return f"{far if there else 'nothing is'} kept in {options.out}; go on: {on}"

    def show(done: int, failed: int, count: int) -> None:
        nonlocal far, first
        far = f"{done} of {count} points are done and"
        if first is None:
            first = done  # which count for no pace
            if not options.json:
                other = folder.ledger.exists() and not done
                why = "; its ledger has no finished walk of these robots and settings"
                say(f"{_points(count)}, {done} of them done before{why * other}", 1)
        about = f"points, {done} of {count} done, {failed} failed"
        progress(about, (done - first) / max(count - first, 1))

    with keeping(kept):
        with bar(quiet=options.json) as progress:
            result = sweeping.carry_on(
                points, folder, workers, scheduler, mix=options.force_mix, show=show
            )
            for line in sweeping.write_run_folders(points, folder):
                cli.notice(f"no run folder or film, {line}", "warning")
        return _print_result(options, result, folder.table)


def merge(options: argparse.Namespace) -> ExitCode:
    """Write the table of all shards, and say what failed."""
    folders = [Path(folder) for folder in options.folders]
    out = Path(options.out or folders[0])
    return _print_result(options, *sweeping.merge(folders, out))


def _print_result(
    options: argparse.Namespace, result: sweeping.Result, table: Path
) -> ExitCode:
    """Say what became of a sweep; the code that it ends with."""
    shown = islice(result.reasons.items(), 5)
    on = command("study", table.parent)
    if SweepFolder(table.parent).table != table:
        on = f"once all parts are walked: {command('merge', table.parent)}"
    cli.report(
        options,
        asdict(result) | {"table": str(table)},
        f"{_points(result.points)}, {result.walked} walked now, {result.failed} failed",
        ", ".join(f"{word} {count}" for word, count in result.verdicts.items()),
        *(f"{count:6}  {reason}" for reason, count in shown),
        f"{'table':8}{table}\n{'next':8}{on}",
    )
    if result.failed and not options.json:
        line = f"{result.failed} of {_points(result.points)} failed"
        cli.notice(f"{line}: {table}; the column status says why", "error")
    return ExitCode.SWEEP if result.failed else ExitCode.OK


def _points(count: int) -> str:
    return f"{count} point{'' if count == 1 else 's'}"


def study(options: argparse.Namespace) -> None:
    """Print what a sweep has found, and draw its maps."""
    given = Path(options.table)
    out = Path(options.out or (given if given.is_dir() else given.parent) / "maps")
    paged = out.suffix in cli.PAGES
    if out.suffix[1:].isalpha() and not paged and not out.is_dir():
        raise UsageError("neither folder nor page", str(out), "end it with .html")
    if options.out is None and out.is_symlink():
        raise UsageError.of("link", out, remedy="give --out")
    asked = prediction_key(options.prediction) if options.prediction else ""
    results = read_results(given, asked)
    folder = new_file(out, "page", *cli.PAGES).parent if paged else ensure_folder(out)
    remedy = "give the table that a sweep has written"
    with cli.working(options, "drawing maps"), blamed_on(given, remedy):
        found = findings(results)
        if paged:
            text = maps.page(results.fitted(), found, given, folder)
            with whole(out, new=True) as part:
                part.write_text(text, "utf-8")
            made: dict[str, object] = {"page": str(out)}
            lines = [f"{'page':8}{out}"]
        else:
            drawn = maps.draw_maps(
                results.fitted(), folder, new=options.out is not None
            )
            made = {"maps": [str(path) for path in drawn]}
            lines = [f"{'map':8}{path}" for path in drawn]
    if (left := len(maps.mapped(results)) - maps.MOST_MAPS) > 0:
        cli.notice(f"pairs of settings that vary and have no map: {left}")
    cli.report(options, asdict(found) | made, found, *lines)


def design(options: argparse.Namespace) -> None:
    """Check every design, walk those that go everywhere, and print the table."""
    robot, out = cli.robot_of(options, options.robot), options.out
    count, legs = count_designs(len(robot.legs)), f"{len(robot.legs)} legs"
    if not count:
        raise UsageError.of("few_legs", options.robot, legs=legs)
    if options.designs is None and count > MOST_DESIGNS:
        raise UsageError.of("designs", options.robot, legs=legs, count=count)
    path = None if out is None else new_file(Path(out), "table", ".parquet")
    count = min(options.designs or count, count)
    rows: list[Mapping[str, Any]] = []

    def kept() -> str:
        if path is None or not path.exists():
            return f"nothing is kept; start again: {again()}"
        on = again(*cli.elsewhere(str(out)))
        return f"{path} has {len(rows)} of {count} designs; start again: {on}"

    with bar(quiet=options.json) as progress, keeping(kept):
        try:
            for row in tried(robot, islice(designs(robot.legs), count), options.walks):
                rows.append(row)
                progress("designs", len(rows) / count)
        finally:
            if path is not None and rows:
                about = {"robot": options.robot, "software": software()}
                write_table(path, rows, about, new=True)
    cli.report(options, rows, render("designs.txt", designs=_by_joints(rows)))


def _by_joints(rows: list[Mapping[str, Any]]) -> Iterator[tuple[object, ...]]:
    """Designs, where they go, all that go everywhere, walks and the best of these."""
    for joints, alike in groupby(rows, itemgetter("joints")):  # in ascending order
        some = list(alike)
        goes = np.array([[row[f"goes.{way}"] for way in DIRECTIONS] for row in some])
        walked = [row for row in some if row.get("min_margin") is not None]
        best = min(walked, key=lambda row: row["strokes_per_metre"], default=None)
        able = goes.all(axis=1).sum()
        yield joints, len(some), goes.sum(axis=0), able, len(walked), best
