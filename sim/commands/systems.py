"""`stratawalk systems`: the systems that come with the package."""

from __future__ import annotations

import argparse
import json
from typing import Any

HELP = "list the shipped systems and their parameters"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command; it has none of its own."""


def execute(options: argparse.Namespace) -> None:
    """Print names, descriptions and parameters."""
    from models import SYSTEMS

    systems = [_facts(name) for name in SYSTEMS]
    if options.json:
        print(json.dumps(systems, indent=1))
        return
    for facts in systems:
        print(f"{facts['name']:18}{facts['description']}")
        if facts["parameters"]:
            given = (f"{k}={json.dumps(v)}" for k, v in facts["parameters"].items())
            print(f"{'':18}--set {' '.join(given)}")


def _facts(name: str) -> dict[str, Any]:
    from models import shipped_system
    from models.systems import parameters

    problem = shipped_system(name)
    return {
        "name": name,
        "description": problem.description,
        "parameters": parameters(name),
        "state": [str(symbol) for symbol in problem.system.state],
        "strata": {s: list(fields) for s, fields in problem.system.strata.items()},
        "gait": problem.gait,
        "elements": problem.elements,
        "goal": problem.goal,
    }
