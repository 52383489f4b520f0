"""`stratawalk adopt`: draft the card of a robot, and show what was guessed."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import add_robot_argument
from sim.errors import UsageError

if TYPE_CHECKING:
    from models import Draft, Source
    from sim.preparation.setup import Setup

HELP = "draft the card of a robot in MJCF or URDF: legs, groups, posture, servos"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    about = "an MJCF or URDF file, or a model folder of MuJoCo Menagerie"
    add_robot_argument(parser, about, metavar="FILE")


def execute(options: argparse.Namespace) -> None:
    """Draft the card, try whether the robot stands, and write it beside the file."""
    from models import draft_card, source_of
    from sim.progress import bar, stage

    source = source_of(options.robot, options.allow_external)
    card, picture = source.path.with_suffix(".toml"), source.path.with_suffix(".png")
    for path in (card, picture, *([] if source.text is None else [source.path])):
        if path.exists():
            raise UsageError(
                "already exists", str(path), "move it away: adopt overwrites no file"
            )
    with bar(quiet=options.json) as progress, stage(progress, "finding the legs"):
        draft = draft_card(source)
    try:
        if source.text is not None:
            source.path.write_text(source.text)
        card.write_text(draft.card)
        with bar(quiet=options.json) as progress:
            with stage(progress, "trying to stand"):
                setup = _tried(source, options.allow_external)
            with stage(progress, "drawing it from above"):
                _draw(setup, draft, picture)
    except BaseException:
        for path in (card, picture, *([] if source.text is None else [source.path])):
            path.unlink(missing_ok=True)
        raise
    _report(source, draft, setup, card, picture, as_json=options.json)


def _tried(source: Source, allow_external: bool) -> Setup:
    """The robot in its world; refused where it does not stand or cannot walk."""
    from models import load
    from sim.preparation.setup import prepare
    from sim.scenarios.file import load_scenario

    robot = load(str(source.path), allow_external=allow_external)
    return prepare(load_scenario("line", {"robot": str(source.path)}), robot)


def _draw(setup: Setup, draft: Draft, picture: Path) -> None:
    from sim.figures.from_above import draw

    draw(setup, draft.gait.pivots, picture)


def _report(
    source: Source,
    draft: Draft,
    setup: Setup,
    card: Path,
    picture: Path,
    *,
    as_json: bool,
) -> None:
    from sim.preparation.inspection import Inspected, describe, facts

    found = facts(Inspected.of(setup))
    written = [str(card), str(picture)]
    if source.text is not None:
        written.insert(0, str(source.path))
    if as_json:
        report = {"written": written, "guesses": draft.guesses, "robot": found}
        print(json.dumps(report, indent=1))
        return
    print(describe(found))
    print()
    for number, guess in enumerate(draft.guesses):
        print(f"{'' if number else 'guessed':12}{guess}")
    for number, path in enumerate(written):
        print(f"{'' if number else 'written':12}{path}")
    trust = " --allow-external" if setup.robot.external else ""
    print(
        f"{'to do':12}read the card, correct what is wrong, and walk: "
        f"stratawalk run line --robot {source.path}{trust}"
    )
