"""Robots: those shipped, in numbers; one adopted from its file; fields measured."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING, Any

from sim.commands import options as cli
from sim.errors import UsageError
from sim.progress import Progress, bar, stage

if TYPE_CHECKING:
    from pathlib import Path

    from models import Draft, Source, TwistModel
    from sim.preparation.setup import Setup

BUDGET = 30.0  # [s] of the processor, to adopt a robot
PLACES = (-1.0, 0.0, 1.0)  # of the span at which measured twists are shown


def robots(options: argparse.Namespace) -> None:
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
    cli.report(options, facts, *lines)


def _show(options: argparse.Namespace) -> None:
    from sim.preparation.inspection import describe, inspected
    from sim.scenarios.file import load_scenario

    scenario = load_scenario("line", {"robot": options.robot})
    with cli.working(options, "trying it out"):
        found = inspected(scenario, cli.robot_of(options, scenario.robot))
    cli.report(options, found, describe(found))


def adopt(options: argparse.Namespace) -> None:
    """Draft the card, try whether the robot stands, and write it beside the file."""
    from models import ModelError, shipped_robots
    from sim.interruption import processor_time
    from sim.preparation.inspection import describe, facts_of

    if options.robot in shipped_robots() and not os.path.exists(options.robot):
        remedy = f"walk it: stratawalk run line --robot {options.robot}"
        raise UsageError("it is shipped with a card", options.robot, remedy)
    too_long = ModelError(
        f"no card was found within {BUDGET:g} s of the processor: {options.robot}; "
        "leave parts out, or write its card by hand as docs/robots.md has it"
    )
    with processor_time(BUDGET, too_long):
        source, draft, setup, written = _adopted(options)
    found, files = facts_of(setup), [str(path) for path in written]
    lines = [
        f"{'' if number else head:12}{line}"
        for head, lines in {"guessed": draft.guesses, "written": files}.items()
        for number, line in enumerate(lines)
    ]
    trust = " --allow-external" if setup.robot.opened.external else ""
    to_do = (
        f"{'to do':12}read the card, which says what each joint does, correct it, and "
        f"walk: stratawalk run line --robot {source.path}{trust}"
    )
    told = {"written": files, "guesses": draft.guesses, "robot": found}
    cli.report(options, told, describe(found), "", *lines, to_do)


def _adopted(options: argparse.Namespace) -> tuple[Source, Draft, Setup, list[Path]]:
    """What was found and what was written, which is nothing where it does not stand."""
    from models import draft_card, load, source_of
    from sim.folder import whole

    source = source_of(options.robot, options.allow_external)
    card, picture = source.path.with_suffix(".toml"), source.path.with_suffix(".png")
    model = [] if source.text is None else [source.path]
    for path in (card, picture, *model):
        if os.path.lexists(path):  # a link may lead anywhere
            raise UsageError(
                "already exists", str(path), "move it away: adopt overwrites no file"
            )
    with cli.working(options, "finding the legs"):
        draft = draft_card(source)
    from sim.figures.mechanism import save_standing
    from sim.preparation.setup import prepare
    from sim.scenarios.file import load_scenario

    try:
        for path, text in ((source.path, source.text), (card, draft.card)):
            if text is not None:
                with whole(path) as part:
                    part.write_text(text)
        with cli.working(options, "trying to stand"):
            name = str(source.path)
            robot = load(name, allow_external=options.allow_external)
            setup = prepare(load_scenario("line", {"robot": name}), robot)
        with cli.working(options, "drawing it from above"), whole(picture) as part:
            save_standing(setup, draft.gait.pivots, part)
    except BaseException:
        for path in (card, picture, *model):
            path.unlink(missing_ok=True)
        raise
    return source, draft, setup, [*model, card, picture]


def identify(options: argparse.Namespace) -> None:
    """Measure, and print every field at three places of its swing."""
    from sim.preparation.setup import prepare
    from sim.scenarios.file import load_scenario

    changes = cli.settings_of(options) | {"robot": options.robot}
    scenario = load_scenario("line", changes)
    robot = cli.robot_of(options, scenario.robot)
    with bar(quiet=options.json) as progress:
        with stage(progress, "compiling"):
            setup = prepare(scenario, robot)
        found = fields(setup, progress)
    cli.report(options, found, *map(_describe, found))


def fields(setup: Setup, progress: Progress) -> list[dict[str, Any]]:
    """Every loaded field: measured, quasi-static and ideal twists along its swing.

    A field that could not be measured has nulls, and the reason.
    """
    import numpy as np

    from sim.experiments.identification import MODELS, identify, twist_model

    identified = identify(setup, progress)
    others = {name: twist_model(setup, name) for name in MODELS if name != "identified"}
    models: dict[str, TwistModel] = {**others, "identified": identified}
    found: list[dict[str, Any]] = []
    for name, field in identified.fields.items():
        stratum, slip = field.stratum, field.slip
        ways, d = field.span * np.array(PLACES), np.array(field.direction)
        at = stratum, ways[:, None] * d, np.tile(d, (len(ways), 1))
        twists = {kind: model(*at).tolist() for kind, model in models.items()}
        along = {"angles": ways.tolist(), "twists": twists, "slip": slip}
        found.append({"field": name, "stratum": stratum, **along, "reason": None})
    unmeasured = {"angles": None, "twists": None, "slip": None}
    return found + [
        {"field": name, "stratum": field.stratum, **unmeasured, "reason": field.reason}
        for name, field in identified.failed.items()
    ]


def _describe(field: dict[str, Any]) -> str:
    place = f"{field['field']} on S{field['stratum']}"
    if field["reason"]:
        return f"{place}: not measured, {field['reason']}\n"
    lines = [
        f"{place}: forward and left [m/rad], yaw [rad/rad]; "
        f"{1e3 * field['slip']:.1f} mm slip in the whole swing"
    ]
    heads = "".join(f"at {angle:+.2f} rad{'':17}" for angle in field["angles"])
    lines.append(f"{'':14}{heads}".rstrip())
    for model, twists in field["twists"].items():
        row = "".join(f"{t[0]:8.4f}{t[1]:9.4f}{t[2]:9.4f}   " for t in twists)
        lines.append(f"{model.replace('_', '-'):14}{row}".rstrip())
    return "\n".join(lines) + "\n"
