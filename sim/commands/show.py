"""`stratawalk show`: the report of a finished run, drawn again and opened."""

from __future__ import annotations

import argparse
import os
import sys

from sim.commands.options import BROWSER, RUN, notice, report, run_of

HELP = "draw the report of a finished run, and open it where there is a display"
OPTIONS = (RUN, BROWSER)


def execute(options: argparse.Namespace) -> None:
    """Draw the report, print its path and open it."""
    from sim.folder import blamed_on
    from sim.progress import bar
    from sim.reports.page import write_report
    from sim.runs.run import read_run

    folder = run_of(options)
    with bar(quiet=options.json) as progress, blamed_on(folder):
        path = write_report(read_run(folder), progress)
    report(options, {"report": str(path)}, path)
    open_page(path.as_uri(), options.browser)


def open_page(address: str, wanted: bool | None) -> None:
    """Open a page in a browser, by default where its window would be seen."""
    import webbrowser

    screen = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not (sys.platform == "darwin" or screen if wanted is None else wanted):
        return
    sys.stdout.flush()
    if not webbrowser.open(address):
        notice(f"no browser found for {address}", "warning")
