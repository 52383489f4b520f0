"""`stratawalk bench`: speed and memory, as ratios measured side by side."""

from __future__ import annotations

import argparse
import json

HELP = "measure speed and memory, side by side with what they are compared to"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command; it has none of its own."""


def execute(options: argparse.Namespace) -> None:
    """Print every measurement as it comes."""
    from dataclasses import asdict

    from sim.bench import measure

    if options.json:
        print(json.dumps([asdict(row) for row in measure()], indent=1))
        return
    for row in measure():
        print(row, flush=True)
