"""`stratawalk scenarios`: the shipped scenarios, or one of them in full."""

from __future__ import annotations

import argparse

from sim.commands.options import option, report

HELP = "list the shipped scenarios, or print one with all its settings"
OPTIONS = (
    option("scenario", metavar="SCENARIO", nargs="?", help="print this one as TOML"),
)


def execute(options: argparse.Namespace) -> None:
    """Print the list, or one scenario."""
    from sim.scenarios.file import dumps, load_scenario, shipped_scenarios, to_table

    if options.scenario:
        one = load_scenario(options.scenario)
        report(options, to_table(one), dumps(one).rstrip())
        return
    all = [load_scenario(name) for name in shipped_scenarios()]
    lines = (f"{s.name:12}{s.segments:4} segments  {s.description}" for s in all)
    report(options, [to_table(scenario) for scenario in all], *lines)
