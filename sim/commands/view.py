"""`stratawalk view`: a finished run in three dimensions, to be looked at and played."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from sim.errors import ExitCode, UsageError

HELP = "look at a finished run in three dimensions, in a browser"
PORTS = 65535


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("run", metavar="RUN", help="folder of a finished run")
    parser.add_argument(
        "--port", type=int, default=0, metavar="N", help="port; or a free one from 8080"
    )
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to listen on; by default this machine alone",
    )
    parser.add_argument(
        "--public",
        action="store_true",
        help="let others connect to --host; there is no password",
    )
    parser.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="against real time, 1"
    )
    parser.add_argument(
        "--replay",
        action="store_true",
        help="write replay.html into the run instead, one file that needs no server",
    )
    parser.add_argument(
        "--browser",
        action=argparse.BooleanOptionalAction,
        help="open it; by default where there is a display",
    )


def execute(options: argparse.Namespace) -> ExitCode:
    """Serve the viewer until Ctrl-C, or write the replay."""
    if options.replay:
        return _write_replay(options)
    from sim.viewing.web import require_loopback, serve

    require_loopback(options.host, options.public)
    if not 0 <= options.port <= PORTS:
        raise UsageError("no port", f"--port {options.port}", f"give 0 to {PORTS}")
    if not 0 < options.speed < float("inf"):
        raise UsageError("no speed", f"--speed {options.speed}", "give 1, or 8, say")

    def started(address: str) -> None:
        _print_address(address, options)

    try:
        serve(Path(options.run), options.host, options.port, options.speed, started)
    except KeyboardInterrupt:
        print(file=sys.stderr)  # the shell's next line begins below ^C
    return ExitCode.OK


def _write_replay(options: argparse.Namespace) -> ExitCode:
    """Write the page, print its path and open it where that can be seen."""
    from sim.commands.show import has_display, open_page
    from sim.progress import bar
    from sim.viewing.replay import write_replay

    with bar(quiet=options.json) as progress:
        path = write_replay(Path(options.run), lambda part: progress("replay", part))
    print(json.dumps({"replay": str(path)}) if options.json else path)
    if has_display() if options.browser is None else options.browser:
        open_page(path.resolve().as_uri())
    return ExitCode.OK


def _print_address(address: str, options: argparse.Namespace) -> None:
    """Print where the page is, and open it where that can be seen."""
    from sim.commands.show import has_display, open_page

    port = address.rstrip("/").rpartition(":")[2]
    print(f"{address}\n\nCtrl-C ends it. From another machine:")
    print(f"  ssh -L {port}:localhost:{port} THIS-MACHINE", flush=True)
    if has_display() if options.browser is None else options.browser:
        open_page(address)
