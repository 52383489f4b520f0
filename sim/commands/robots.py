"""`stratawalk robots`: the shipped robots, or one robot in numbers."""

from __future__ import annotations

import argparse

from sim.commands.options import report, robot_of, robot_options

HELP = "list the shipped robots, or check one and show it in numbers"
OPTIONS = robot_options(
    "a shipped robot, or your FILE.xml with its card (docs/robots.md)", nargs="?"
)


def execute(options: argparse.Namespace) -> None:
    """Print names and descriptions, or everything about one robot."""
    if options.robot is not None:
        _show(options)
        return
    from models import load, shipped_robots

    cards = {name: load(name).card for name in shipped_robots()}
    facts = [
        {
            "name": name,
            "description": card.description,
            "legs": sorted(card.legs),
            "groups": {group: sorted(of.legs) for group, of in card.groups.items()},
            "gait": list(card.gait),
        }
        for name, card in cards.items()
    ]
    lines = (f"{n:20}{len(c.legs)} legs  {c.description}" for n, c in cards.items())
    report(options, facts, *lines)


def _show(options: argparse.Namespace) -> None:
    from sim.preparation.inspection import describe, facts, inspected
    from sim.progress import bar, stage
    from sim.scenarios.file import load_scenario

    scenario = load_scenario("line", {"robot": options.robot})
    with bar(quiet=options.json) as progress, stage(progress, "trying it out"):
        found = facts(inspected(scenario, robot_of(options, scenario.robot)))
    report(options, found, describe(found))
