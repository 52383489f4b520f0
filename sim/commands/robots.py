"""`stratawalk robots`: the shipped robots, or one robot in numbers."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from sim.commands.options import robot_of, robot_options

if TYPE_CHECKING:
    from models import Card

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
    if options.json:
        print(
            json.dumps([_facts(name, card) for name, card in cards.items()], indent=1)
        )
        return
    for name, card in cards.items():
        print(f"{name:20}{len(card.legs)} legs  {card.description}")


def _show(options: argparse.Namespace) -> None:
    from sim.preparation.inspection import describe, facts, inspected
    from sim.progress import bar, stage
    from sim.scenarios.file import load_scenario

    scenario = load_scenario("line", {"robot": options.robot})
    with bar(quiet=options.json) as progress, stage(progress, "trying it out"):
        found = facts(inspected(scenario, robot_of(options, scenario.robot)))
    print(json.dumps(found, indent=1) if options.json else describe(found))


def _facts(name: str, card: Card) -> dict[str, object]:
    return {
        "name": name,
        "description": card.description,
        "legs": sorted(card.legs),
        "groups": {group: sorted(of.legs) for group, of in card.groups.items()},
        "gait": list(card.gait),
    }
