"""Robots: those shipped, in numbers; one adopted from its file; fields measured."""

import argparse
import os
import re
from pathlib import Path
from typing import Any

import numpy as np

import models
from planner.support import unfinished
from sim.commands import options as cli
from sim.endings import command
from sim.errors import UsageError, message
from sim.folder import whole
from sim.interruption import processor_time
from sim.preparation.inspection import Facts, inspected
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, bar, stage
from sim.scenarios.file import load_scenario
from sim.templates import render

Adopted = tuple[models.Draft, models.Robot, Facts, list[Path]]
BUDGET = 30.0  # [s] of the processor, to adopt a robot


def robots(options: argparse.Namespace) -> None:
    """Print names and descriptions, or everything about one robot."""
    if options.robot is not None:
        scenario = load_scenario("line", {"robot": options.robot})
        with cli.working(options, "trying it out"):
            found = inspected(scenario, cli.robot_of(options, scenario.robot))
        cli.report(options, found, render("robot.txt", **found))
        return
    cards = {name: models.load(name).card for name in models.shipped_robots()}
    facts = []
    for name, card in cards.items():
        groups = {group: sorted(of.legs) for group, of in card.groups.items()}
        said = {"name": name, "description": card.description}
        more = {"groups": groups, "gait": list(card.gait)}
        facts.append(said | {"legs": sorted(card.legs)} | more)
    lines = (f"{n:20}{len(c.legs)} legs  {c.description}" for n, c in cards.items())
    cli.report(options, facts, *lines)


def adopt(options: argparse.Namespace) -> None:
    """Draft the card, try whether the robot stands, and write it beside the file."""
    if options.robot in models.shipped_robots() and not os.path.exists(options.robot):
        raise UsageError.of("shipped_card", options.robot, robot=options.robot)
    late = message("no_card_found", robot=options.robot, seconds=BUDGET)
    with processor_time(BUDGET, models.ModelError(late)):
        draft, robot, found, written = _adopted(options)
    facts = {"written": [*map(str, written)], "guesses": draft.guesses, "robot": found}
    trusted = ["--allow-external"] if robot.opened.external else []
    walk = command("run", "line", "--robot", robot.path, *trusted)
    text = render("adopted.txt", walk=walk, **facts)
    cli.report(options, facts, render("robot.txt", **found), text)


def _adopted(options: argparse.Namespace) -> Adopted:
    """What was found and what was written, which is nothing where it does not stand."""
    source = models.source_of(options.robot, options.allow_external)
    card, picture = source.path.with_suffix(".toml"), source.path.with_suffix(".png")
    model = [] if source.text is None else [source.path]
    taken = filter(os.path.lexists, (card, picture, *model))  # also as a link
    if names := " and ".join(map(str, taken)):
        raise UsageError.of("adopted", names)
    with cli.working(options, "finding the legs"):
        draft = models.draft_card(source)
    from sim.figures.mechanism import save_standing  # loads matplotlib

    with whole(card, new=True) as part:  # of two at once, one goes on
        part.write_text(draft.card, "utf-8")
    try:
        with unfinished(card):
            if source.text is not None:
                with whole(source.path, new=True) as part:
                    part.write_text(source.text, "utf-8")
            with unfinished(*model):
                with cli.working(options, "trying to stand"):
                    name = str(source.path)
                    robot = models.load(name, allow_external=options.allow_external)
                    setup = prepare(load_scenario("line", {"robot": name}), robot)
                    found = inspected(setup.scenario, robot)
                drawing = cli.working(options, "drawing it from above")
                with drawing, whole(picture, new=True) as part:
                    save_standing(setup, draft.gait.pivots, part)
    except models.ModelError as error:
        drafted = f"{re.escape(str(source.path.with_suffix('')))}[.](xml|toml)"
        told = re.sub(drafted, lambda _: str(source.given), str(error))
        raise models.ModelError(told) from error  # about the file that is still there
    return draft, robot, found, [*model, card, picture]


def identify(options: argparse.Namespace) -> None:
    """Measure, and print every field at three places of its swing."""
    changes = cli.settings_of(options) | {"robot": options.robot}
    scenario = load_scenario("line", changes)
    robot = cli.robot_of(options, scenario.robot)
    with bar(quiet=options.json) as progress:
        with stage(progress, "compiling"):
            setup = prepare(scenario, robot)
        found = fields(setup, progress)
    cli.report(options, found, render("fields.txt", fields=found))


def fields(setup: Setup, progress: Progress) -> list[dict[str, Any]]:
    """Twists of every loaded field along its swing; nulls and a reason without."""
    from sim.experiments.identification import identify, twist_model

    identified = identify(setup, progress)
    models = {name: twist_model(setup, name) for name in ("ideal", "quasi_static")}
    models["identified"] = identified
    found: list[dict[str, Any]] = []
    for name, field in identified.fields.items():
        stratum, slip = field.stratum, field.slip
        ways, d = field.span * np.array((-1.0, 0.0, 1.0)), np.array(field.direction)
        at = stratum, ways[:, None] * d, np.tile(d, (len(ways), 1))
        twists = {kind: model(*at).tolist() for kind, model in models.items()}
        along = {"angles": ways.tolist(), "twists": twists, "slip": slip}
        found.append({"field": name, "stratum": stratum, **along, "reason": None})
    unmeasured = {"angles": None, "twists": None, "slip": None}
    return found + [
        {"field": name, "stratum": field.stratum, **unmeasured, "reason": field.reason}
        for name, field in identified.failed.items()
    ]
