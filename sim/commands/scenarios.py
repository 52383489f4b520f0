"""`stratawalk scenarios`: the shipped scenarios, or one of them in full."""

from __future__ import annotations

import argparse
import json

HELP = "list the shipped scenarios, or print one with all its settings"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "scenario", metavar="SCENARIO", nargs="?", help="print this one as TOML"
    )


def execute(options: argparse.Namespace) -> None:
    """Print the list, or one scenario."""
    from sim.scenarios.file import dumps, load_scenario, shipped_scenarios, to_table

    if options.scenario:
        scenario = load_scenario(options.scenario)
        print(
            json.dumps(to_table(scenario)) if options.json else dumps(scenario).rstrip()
        )
        return
    scenarios = [load_scenario(name) for name in shipped_scenarios()]
    if options.json:
        print(json.dumps([to_table(scenario) for scenario in scenarios], indent=1))
        return
    for scenario in scenarios:
        print(
            f"{scenario.name:12}{scenario.segments:4} segments  {scenario.description}"
        )
