"""`stratawalk compare`: several runs as one table, and as one page."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import option, report
from sim.errors import UsageError

if TYPE_CHECKING:
    from sim.reports.tables import Table

HELP = "compare finished runs: settings that differ first, then what came of them"
OPTIONS = (
    option(
        "runs", metavar="RUN", nargs="+", help="folders of finished runs, at least two"
    ),
    option(
        "--out", metavar="FILE.html", help="page to make, with the paths of all runs"
    ),
)


def execute(options: argparse.Namespace) -> None:
    """Print the comparison, and write its page."""
    if len(options.runs) < 2:
        what = "a single run is compared to nothing"
        raise UsageError(what, options.runs[0], "give two or more, or use show")
    if options.out is not None and Path(options.out).suffix not in (".html", ".htm"):
        raise UsageError(
            "not a page's name", f"--out {options.out}", "give a name in .html"
        )
    from sim.folder import RunFolder, blamed_on, ensure_folder
    from sim.progress import bar
    from sim.reports.comparison import compare, names, page
    from sim.runs.run import read_run

    runs = []
    with bar(quiet=options.json) as progress:
        for number, folder in enumerate(map(Path, options.runs), start=1):
            with blamed_on(folder):
                runs.append(read_run(folder))
                compare([runs[-1], runs[-1]])
            progress("reading", number / len(options.runs))
        compared = compare(runs)
        if options.out is not None:
            with blamed_on(runs[0].folder):
                text = page(compared, progress)
            path = Path(options.out)
            shelf = RunFolder(ensure_folder(path.parent, "page's folder"))
            shelf.write_text(path.name, text)
    tables = {
        "settings": compared.differences,
        "results": compared.results,
        "drift": compared.drift,
    }
    facts = {key: _by_run(table, names(runs)) for key, table in tables.items()}
    lines = [_text(compared.differences), _text(compared.results)]
    if compared.drift.rows:
        lines.append(_text(compared.drift))
    if options.out is not None:
        lines.append(f"{'page':13}{options.out}")
    report(options, facts | {"page": options.out}, "\n\n".join(lines))


def _by_run(table: Table, names: list[str]) -> list[dict[str, str]]:
    """A row a run, in the order given."""
    return [
        {"run": name} | {row[0]: row[column] for row in table.rows}
        for column, name in enumerate(names, start=1)
    ]


def _text(table: Table) -> str:
    """The table in columns; settings that do not differ are not in it."""
    if not table.rows:
        return "All settings are the same."
    rows = [table.header, *table.rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) for cell, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    )
