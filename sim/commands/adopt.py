"""`stratawalk adopt`: draft the card of a robot, and show what was guessed."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import report, robot_options
from sim.errors import UsageError

if TYPE_CHECKING:
    from models import Draft, Source
    from sim.preparation.setup import Setup

HELP = "draft the card of a robot in MJCF or URDF: legs, groups, posture, servos"
BUDGET = 30.0  # [s] of the processor
OPTIONS = robot_options(
    "an MJCF or URDF file, or a model folder of MuJoCo Menagerie", "FILE"
)


def execute(options: argparse.Namespace) -> None:
    """Draft the card, try whether the robot stands, and write it beside the file."""
    from models import ModelError
    from sim.interruption import processor_time

    too_long = ModelError(
        f"no card was found within {BUDGET:g} s of the processor: {options.robot}; "
        "leave parts out, or write its card by hand as docs/robots.md has it"
    )
    with processor_time(BUDGET, too_long):
        adopted = _adopted(options)
    _report(options, *adopted)


def _adopted(options: argparse.Namespace) -> tuple[Source, Draft, Setup, list[Path]]:
    """What was found and what was written, which is nothing where it does not stand."""
    from models import draft_card, load, source_of
    from sim.folder import whole
    from sim.progress import bar, stage

    source = source_of(options.robot, options.allow_external)
    card, picture = source.path.with_suffix(".toml"), source.path.with_suffix(".png")
    model = [] if source.text is None else [source.path]
    for path in (card, picture, *model):
        if os.path.lexists(path):  # a link may lead anywhere
            raise UsageError(
                "already exists", str(path), "move it away: adopt overwrites no file"
            )
    with bar(quiet=options.json) as progress, stage(progress, "finding the legs"):
        draft = draft_card(source)
    from sim.figures.from_above import draw
    from sim.preparation.setup import prepare
    from sim.scenarios.file import load_scenario

    try:
        for path, text in ((source.path, source.text), (card, draft.card)):
            if text is not None:
                with whole(path) as part:
                    part.write_text(text)
        with bar(quiet=options.json) as progress:
            with stage(progress, "trying to stand"):
                robot = load(str(source.path), allow_external=options.allow_external)
                setup = prepare(
                    load_scenario("line", {"robot": str(source.path)}), robot
                )
            with stage(progress, "drawing it from above"), whole(picture) as part:
                draw(setup, draft.gait.pivots, part)
    except BaseException:
        for path in (card, picture, *model):
            path.unlink(missing_ok=True)
        raise
    return source, draft, setup, [*model, card, picture]


def _report(
    options: argparse.Namespace,
    source: Source,
    draft: Draft,
    setup: Setup,
    written: list[Path],
) -> None:
    from sim.preparation.inspection import Inspected, describe, facts

    found, files = facts(Inspected.of(setup)), [str(path) for path in written]
    lines = [
        f"{'' if number else head:12}{line}"
        for head, lines in {"guessed": draft.guesses, "written": files}.items()
        for number, line in enumerate(lines)
    ]
    trust = " --allow-external" if setup.robot.opened.external else ""
    to_do = (
        f"{'to do':12}read the card, correct what is wrong, and walk: "
        f"stratawalk run line --robot {source.path}{trust}"
    )
    written_down = {"written": files, "guesses": draft.guesses, "robot": found}
    report(options, written_down, describe(found), "", *lines, to_do)
