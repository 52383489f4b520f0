"""The card of a robot with what was fitted to its logs, and where that came from."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path

from models import Robot
from sim.errors import UsageError
from sim.fitting.fitting import Told
from sim.folder import whole

FITTED = "\n[fitted]\n"  # the last table of a card


def card_text(robot: Robot, told: Told, sources: Sequence[str]) -> str:
    """The robot's card with settings that its logs told, in place of earlier ones."""
    lines = [f"{key} = {json.dumps(value)}" for key, (value, _) in told.items()]
    errors = [f"{key} = {json.dumps(error)}" for key, (_, error) in told.items()]
    came = f"source = {json.dumps(list(sources), ensure_ascii=False)}"
    table = [*lines, came, "", "[fitted.errors]", *errors]
    return robot.card_text.partition(FITTED)[0] + FITTED + "\n".join(table) + "\n"


def check_free(card: Path) -> None:
    """Refuse a name that is no card's, or that is taken."""
    if card.suffix != ".toml" or not card.parent.is_dir():
        remedy = "give --out FOLDER/NAME.toml"
        raise UsageError("no place for a card", str(card), remedy)
    if os.path.lexists(card):
        raise UsageError("already exists", str(card), "give --out another name")


def write_card(robot: Robot, card: Path, text: str) -> str:
    """Write a card, and the robot's file beside it if it is one alone.

    Returns how to use it, in words.
    """
    with whole(card) as part:
        part.write_text(text)
    model = card.with_suffix(".xml")
    alone = robot.is_shipped or robot.opened.files in ((), (robot.path,))
    if not alone or robot.has_card_inside:
        return f"{card}; put it in the place of the robot's own card"
    if not os.path.lexists(model):
        with whole(model) as part:
            part.write_text(robot.read().to_xml())
    return f"{card}; use it as --robot {model}"
