"""Runs beside one another, beside small changes of one, and the paper's own figures."""

import argparse
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from models import Robot
from sim import palette
from sim.commands import options as cli
from sim.endings import command, keeping
from sim.errors import UsageError
from sim.folder import blamed_on, claim, new_file, whole
from sim.motion.poses import POSE
from sim.progress import bar, say
from sim.reports import comparison
from sim.reports.tables import Table
from sim.runs.run import Run, read_run
from sim.templates import render

PICTURES = (".png", ".svg", ".pdf")
KEY = "arrows from feet: a change of that leg\nfrom the middle: of body, floor, servos"


def compare(options: argparse.Namespace) -> None:
    """Print the comparison, and write its page."""
    if len(options.runs) < 2:
        newest = cli.runs_in(Path(options.runs[0]))[1::-1]
        two = f"write {command('compare', *newest)}" if newest[1:] else ""
        ways = two or "give two or more, or stratawalk show RUN"
        raise UsageError("a single run cannot be compared", options.runs[0], ways)
    runs, out = [], options.out
    path = None if out is None else new_file(Path(out), "page", *cli.PAGES)
    with bar(quiet=options.json) as progress:
        for number, folder in enumerate(map(Path, options.runs), start=1):
            with blamed_on(folder):
                runs.append(read_run(folder))
                comparison.compare([runs[-1], runs[-1]])
            progress("reading", number / len(options.runs))
        compared = comparison.compare(runs)
        if path is not None:
            with blamed_on(runs[0].folder):
                text = comparison.page(compared, progress)
            with whole(path, new=True) as part:
                part.write_text(text, "utf-8")
    tables = {"settings": compared.differences, "results": compared.results}
    tables |= {"drift": compared.drift, "left": compared.left}
    facts = {  # a row a run, in the order given
        key: [
            {"run": name} | {row[0]: row[column] for row in table.rows}
            for column, name in enumerate(comparison.names(runs), start=1)
        ]
        for key, table in tables.items()
    }
    lines = [_text(t) for key, t in tables.items() if t.rows or key == "settings"]
    if path is not None:
        lines.append(f"{'page':13}{path}")
    cli.report(options, facts | {"page": options.out}, "\n\n".join(lines))


def _text(table: Table) -> str:
    """The table in columns; settings that do not differ are not in it."""
    if not table.rows:
        return "All settings are the same."
    rows = [table.header, *table.rows]
    first, *others = (max(map(len, column)) for column in zip(*rows, strict=True))
    return "\n".join(
        "  ".join([name.ljust(first), *map(str.rjust, cells, others)])
        for name, *cells in rows
    )


def sensitivities(options: argparse.Namespace) -> None:
    """Print the table, and draw the picture if one is asked for."""
    folder, out = cli.run_of(options), options.out
    path = None if out is None else new_file(Path(out), "picture", *PICTURES)
    with blamed_on(folder), cli.working(options, "predicting changed robots"):
        run = read_run(folder)
        robot = cli.robot_of(options, run.scenario.robot, run.scenario.geometry)
        found = rows(run, robot)
    if path is not None:
        draw(run, found, path)
    cli.report(options, found, render("sensitivities.txt", rows=found))


def rows(run: Run, robot: Robot) -> list[dict[str, Any]]:
    """Changes with their units and what one of them does, `x`, `y` [m], `yaw` [rad]."""
    from sim.studies.sensitivities import sensitivities_of

    found = sensitivities_of(run, robot)
    return [
        {"what": each.what, "unit": each.unit} | dict(zip(POSE, moved, strict=True))
        for each, moved in zip(found.changes, found.pose[:, 0].tolist(), strict=True)
    ]


def draw(run: Run, found: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Arrows from the feet, for the kinds of change there that move the end most."""
    from matplotlib.figure import Figure

    feet = run.contact_point[0] - run.achieved[0, :2]
    ways = [float(np.hypot(row["x"], row["y"])) for row in found]
    scale = 0.6 * float(np.abs(feet).max()) / (max(ways) or 1.0)
    ranked = [found[place] for place in np.argsort(ways)[::-1]]
    colours = dict(zip(dict.fromkeys(map(_kind, ranked)), palette.RUNS, strict=False))
    figure = Figure(figsize=(8.5, 6.0), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    axes.plot(*feet.T, "o", color=palette.OUTLINE.hex)
    for number, foot in zip(run.legs, feet.tolist(), strict=True):
        name, place = f"leg {number}", "offset points"
        axes.annotate(name, foot, (8, 0), textcoords=place, va="center")
    axes.margins(0.2)
    for row in (row for row in ranked if _kind(row) in colours):
        leg = str(row["what"]).rpartition("leg ")[2]
        own = feet[run.legs.index(int(leg))] if leg.isdigit() else np.zeros(2)
        at = float(own[0]), float(own[1])
        tip = at[0] + scale * row["x"], at[1] + scale * row["y"]
        arrow = {"arrowstyle": "->", "color": colours[_kind(row)].hex}
        axes.annotate("", tip, at, arrowprops=arrow)
        axes.plot(*tip, alpha=0)
    for kind, colour in colours.items():
        axes.plot([], [], color=colour.hex, label=kind)
    figure.legend(loc="outside right upper", title=KEY)
    title = f"How far the walk's end moves, drawn {scale:.3g} times as long"
    axes.set(xlabel="x [m], forward", ylabel="y [m], left", title=title)
    with whole(path, new=True) as part:
        figure.savefig(part, dpi=120, bbox_inches="tight")


def _kind(row: Mapping[str, Any]) -> str:
    return f"{row['unit']}: {str(row['what']).partition(' of leg')[0]}"


def figures(options: argparse.Namespace) -> None:
    """Draw the figures, name each when it is written, and print their folder."""
    from sim.figures.sheet import draw

    folder = claim(options.out and Path(options.out), "figures")
    kept = partial(cli.kept_in, folder.path, options.out)
    try:
        with bar(quiet=options.json) as progress, keeping(kept):
            facts = {}
            for sheet in draw(folder, options.only, progress=progress):
                facts[sheet.name] = sheet.caption
                if not options.json:
                    say(f"{sheet.name:26}{sheet.title}", 1)
    finally:
        folder.discard_if_empty()
    where = f"\n{'folder':26}{folder.path}\n{'captions and tables':26}figures.md in it"
    cli.report(options, {"folder": str(folder.path), "figures": facts}, where)
