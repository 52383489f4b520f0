"""`stratawalk show`: the report of a finished run, drawn again and opened."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

HELP = "draw the report of a finished run, and open it where there is a display"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("run", metavar="RUN", help="folder of a finished run")
    parser.add_argument(
        "--browser",
        action=argparse.BooleanOptionalAction,
        help="open it; by default where there is a display",
    )


def execute(options: argparse.Namespace) -> None:
    """Draw the report, print its path and open it."""
    from sim.folder import blamed_on
    from sim.progress import bar
    from sim.reports.page import write_report
    from sim.runs.run import read_run

    folder = Path(options.run)
    with bar(quiet=options.json) as progress, blamed_on(folder):
        path = write_report(read_run(folder), progress)
    print(json.dumps({"report": str(path)}) if options.json else path)
    if has_display() if options.browser is None else options.browser:
        sys.stdout.flush()
        open_page(path.as_uri())


def has_display() -> bool:
    """Whether a browser's window would be seen by the one who asked for it."""
    screen = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return sys.platform == "darwin" or bool(screen)


def open_page(address: str) -> None:
    """Open a page in the user's browser, or say that there is none."""
    import webbrowser

    if not webbrowser.open(address):
        print(f"stratawalk: warning: no browser found for {address}", file=sys.stderr)
