"""`stratawalk bench`: speed and memory side by side, and other planners."""

from __future__ import annotations

import argparse
import subprocess
import sys
from dataclasses import asdict
from importlib.util import find_spec

from sim.commands.options import needs_extra, option, report
from sim.errors import ROOT, UsageError

HELP = "measure speed and memory, side by side with what they are compared to"
OPTIONS = (
    option(
        "--sweeps",
        action="store_true",
        help="measure sweeps instead, against a bare batch (extra `sweep`)",
    ),
    option(
        "--peers",
        action="store_true",
        help="compare plans with those of OMPL and CasADi (extra `peers`)",
    ),
)


@needs_extra("peers")
def execute(options: argparse.Namespace) -> None:
    """Print every measurement when it is done."""
    if options.peers:
        _compare_peers(["--json"] if options.json else [])
        return
    if options.sweeps:
        from sim.bench.sweep_speed import measure
    else:
        from sim.bench.speed import measure
    rows = measure()
    if options.json:
        report(options, [asdict(row) for row in rows])
        return
    for row in rows:
        print(row, flush=True)


def _compare_peers(options: list[str]) -> None:
    """Run the script that knows the other planners; it is part of a checkout only."""
    if not (ROOT / "scripts" / "bench_peers.py").is_file():
        raise UsageError(
            "the other planners are not part of an installed package",
            "bench --peers",
            "run it in a checkout of the project",
        )
    for package in ("casadi", "ompl"):
        if find_spec(package) is None:
            raise ModuleNotFoundError(name=package)
    script = [sys.executable, "-m", "scripts.bench_peers", *options]
    subprocess.run(script, cwd=ROOT, check=True)
