"""`stratawalk bench`: speed and memory side by side, and other planners."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from typing import Any

HELP = "measure speed and memory, side by side with what they are compared to"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "--sweeps",
        action="store_true",
        help="measure sweeps instead, against a bare batch (extra `sweep`)",
    )
    parser.add_argument(
        "--peers",
        action="store_true",
        help="compare plans with those of OMPL and CasADi (extra `peers`)",
    )


def execute(options: argparse.Namespace) -> None:
    """Print every measurement when it is done."""
    from dataclasses import asdict

    if options.peers:
        rows = _peers()
    else:
        rows = _sweeps() if options.sweeps else _measurements()
    if options.json:
        print(json.dumps([asdict(row) for row in rows], indent=1))
        return
    for row in rows:
        print(row, flush=True)


def _peers() -> Iterator[Any]:
    from sim.bench.peers import measure

    return measure()


def _sweeps() -> Iterator[Any]:
    from sim.bench.sweep_speed import measure

    return measure()


def _measurements() -> Iterator[Any]:
    from sim.bench.speed import measure

    return measure()
