"""`stratawalk run`: plan, walk in MuJoCo, compare, film; leaves a run folder."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sim.commands.options import add_scenario_arguments, folder_of, scenario_of
from sim.commands.trusted import robot_of
from sim.errors import RenderError, one_line

if TYPE_CHECKING:
    from sim.folder import RunFolder

HELP = "plan a scenario, walk it in MuJoCo, compare the two and film it"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_scenario_arguments(parser)
    parser.add_argument(
        "--out", metavar="DIR", help="run folder to make; otherwise runs/SCENARIO-NNN"
    )
    parser.add_argument(
        "--video",
        action=argparse.BooleanOptionalAction,
        help="film the walk; by default if this machine can draw",
    )
    parser.add_argument(
        "--look", choices=("draft", "final"), default="draft", help="look of the film"
    )


def execute(options: argparse.Namespace) -> None:
    """Walk the scenario and print how it went."""
    scenario = scenario_of(options)

    from sim.folder import claim
    from sim.progress import bar
    from sim.run_folder import run

    robot = robot_of(options, scenario.robot)  # the slow part comes after refusals
    look = options.look if _can_film(options.video) else None
    folder = claim(folder_of(options), scenario.name)
    try:
        with bar(quiet=options.json) as progress:
            summary = run(scenario, folder, robot=robot, look=look, progress=progress)
    finally:
        folder.discard_if_empty()
    print(json.dumps(summary) if options.json else _report(summary, folder))


def _can_film(wanted: bool | None) -> bool:
    """Whether to film; a film that was asked for and cannot be drawn is an error."""
    if wanted is False:
        return False
    from sim.pictures.direction import check

    try:
        check()
    except RenderError as error:
        if wanted:
            raise
        print(f"stratawalk: warning: no film: {one_line(error)}", file=sys.stderr)
        return False
    return True


def _report(summary: Mapping[str, Any], folder: RunFolder) -> str:
    from sim.evaluation.comparison import describe

    lines = [describe(summary), "", f"{'folder':13}{folder.path}"]
    film = folder.path / "video.mp4"
    if film.exists():
        lines.append(f"{'film':13}{film}")
    return "\n".join(lines)
