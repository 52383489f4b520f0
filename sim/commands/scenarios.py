"""`stratawalk scenarios`: the shipped scenarios, or one of them in full."""

from __future__ import annotations

import argparse
import json

from sim.commands.options import option

HELP = "list the shipped scenarios, or print one with all its settings"
OPTIONS = (
    option("scenario", metavar="SCENARIO", nargs="?", help="print this one as TOML"),
)


def execute(options: argparse.Namespace) -> None:
    """Print the list, or one scenario."""
    from sim.scenarios.file import dumps, load_scenario, shipped_scenarios, to_table

    if options.scenario:
        one = load_scenario(options.scenario)
        print(json.dumps(to_table(one)) if options.json else dumps(one).rstrip())
        return
    scenarios = [load_scenario(name) for name in shipped_scenarios()]
    if options.json:
        print(json.dumps([to_table(scenario) for scenario in scenarios], indent=1))
        return
    for one in scenarios:
        print(f"{one.name:12}{one.segments:4} segments  {one.description}")
