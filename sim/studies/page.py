"""The page of a study: its maps, in classes fitted to the data, and its extremes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from shlex import quote

import numpy as np
from markupsafe import Markup

from sim.reports.drawing import Drawing, finish
from sim.reports.tables import Table
from sim.reports.templates import render
from sim.scenarios.file import toml_value
from sim.studies.maps import figures
from sim.studies.results import Findings, Results
from sim.sweeps.folder import run_folder

EXTREMES = 5  # points among the best, and among the worst


def page(results: Results, found: Findings, table: Path, beside: Path) -> str:
    """The page as HTML, which will lie in a folder, with links relative to it."""
    walked = np.flatnonzero(np.isfinite(results.off))
    order = walked[np.argsort(results.off[walked], kind="stable")].tolist()
    worst = [*order[: -EXTREMES - 1 : -1]]
    best = [point for point in order[:EXTREMES] if point not in worst]
    folder = table if table.is_dir() else table.parent
    places = os.path.relpath(folder, beside)
    name = folder.resolve().name
    counts = [(c, str(n), f"{n / len(results):.0%}") for c, n in found.classes.items()]
    counts += [(f"no walk: {why}", str(n), "") for why, n in found.reasons.items()]
    shares = [
        (key, *("–" if s is None else f"{s:.0%}" for s in (one.departure, one.falls)))
        for key, one in found.explained.items()
    ]
    return render(
        "study.html",
        title=f"{name}: {len(results)} points",
        about=f"{', '.join(results.keys)} vary",
        label=results.label,
        counts=Table(("farthest off, of the path", "points", "share"), counts),
        explained=Table(("alone explains", "of departures", "of lost walks"), shares),
        maps=list(_drawn(results)),
        worst=_points(results, worst, folder, places),
        best=_points(results, best, folder, places),
    )


def _drawn(results: Results) -> Iterator[Drawing]:
    for keys, figure in figures(results, "none"):
        yield finish(figure, " and ".join(keys), [])


def _points(
    results: Results, points: Sequence[int], folder: Path, places: str
) -> Table:
    """Points with their settings, and the report of each or the command that walks."""
    rows = []
    for i in points:
        number = int(results.column("point")[i])
        settings = {key: results.columns[key][i] for key in results.keys}
        own = run_folder(number)
        if (folder / own / "report.html").exists():
            link = Markup('<a href="{}">report</a>').format(
                f"{places}/{own}/report.html"
            )
        else:
            fixed = {**results.asked.get("set", {}), **settings}
            words = (f"{key}={toml_value(value)}" for key, value in fixed.items())
            name = quote(str(results.asked.get("scenario", {}).get("name", "SCENARIO")))
            sets = " ".join(f"--set {quote(word)}" for word in words)
            link = Markup("<code>stratawalk run {} {}</code>").format(name, sets)
        cells = (toml_value(value) for value in settings.values())
        rows.append((str(number), f"{100 * results.off[i]:.3g} %", *cells, link))
    return Table(("point", "farthest off", *results.keys, "look at it"), rows)
