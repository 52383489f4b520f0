"""`stratawalk robots`: the robots that come with the package."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from models.card import Card

HELP = "list the shipped robots"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command; it has none of its own."""


def execute(options: argparse.Namespace) -> None:
    """Print names and descriptions."""
    from models.library import load, robots

    cards = {name: load(name).card for name in robots()}
    if options.json:
        print(
            json.dumps([_facts(name, card) for name, card in cards.items()], indent=1)
        )
        return
    for name, card in cards.items():
        print(f"{name:20}{len(card.legs)} legs  {card.description}")


def _facts(name: str, card: Card) -> dict[str, object]:
    return {
        "name": name,
        "description": card.description,
        "legs": sorted(card.legs),
        "groups": {group: sorted(of.legs) for group, of in card.groups.items()},
        "gait": list(card.gait),
    }
