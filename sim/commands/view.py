"""`stratawalk view`: a finished run in three dimensions, to be looked at and played."""

from __future__ import annotations

import argparse
import sys
from urllib.parse import urlsplit

from sim.commands.options import BROWSER, RUN, option, report, run_of
from sim.commands.show import open_page
from sim.errors import UsageError

HELP = "look at a finished run in three dimensions, in a browser"
PORTS = 65535
OPTIONS = (
    RUN,
    option(
        "--port", type=int, default=0, metavar="N", help="port; or a free one from 8080"
    ),
    option(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to listen on; by default this machine alone",
    ),
    option(
        "--public",
        action="store_true",
        help="let others connect to --host; nothing is encrypted",
    ),
    option(
        "--speed", type=float, default=1.0, metavar="X", help="against real time, 1"
    ),
    option(
        "--replay",
        action="store_true",
        help="write replay.html into the run instead, one file that needs no server",
    ),
    BROWSER,
)


def execute(options: argparse.Namespace) -> None:
    """Serve the viewer until Ctrl-C, or write the replay."""
    if options.replay:
        _write_replay(options)
        return
    from sim.viewing.web import require_loopback, serve

    require_loopback(options.host, options.public)
    if not 0 <= options.port <= PORTS:
        raise UsageError("no port", f"--port {options.port}", f"give 0 to {PORTS}")
    if not 0 < options.speed < float("inf"):
        raise UsageError("no speed", f"--speed {options.speed}", "give 1, or 8, say")

    def started(address: str) -> None:
        port = urlsplit(address).port
        print(f"{address}\n\nCtrl-C ends it. From another machine, open it after:")
        print(f"  ssh -L {port}:localhost:{port} THIS-MACHINE", flush=True)
        open_page(address, options.browser)

    try:
        serve(run_of(options), options.host, options.port, options.speed, started)
    except KeyboardInterrupt:
        print(file=sys.stderr)  # the shell's next line begins below ^C


def _write_replay(options: argparse.Namespace) -> None:
    """Write the page, print its path and open it where that can be seen."""
    from sim.progress import bar
    from sim.viewing.replay import write_replay

    with bar(quiet=options.json) as progress:
        path = write_replay(run_of(options), lambda part: progress("replay", part))
    report(options, {"replay": str(path)}, path)
    open_page(path.resolve().as_uri(), options.browser)
