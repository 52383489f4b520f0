"""Options that `run` and `plan` share, and the scenario that they select."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.trusted import add_trust_argument
from sim.errors import UsageError

if TYPE_CHECKING:
    from sim.scenarios.scenario import Scenario

NAMED = (
    "robot", "fields", "segments", "replan", "steer", "degree", "words",
    "allow_unstable", "optimise", "correct", "gait",
)  # fmt: skip
"""Options that are also keys of a scenario."""


def add_scenario_arguments(
    parser: argparse.ArgumentParser, metavar: str = "SCENARIO", about: str = ""
) -> None:
    """Add the arguments that select a scenario and replace its settings.

    Args:
        parser: Parser of the command.
        metavar: What the command takes.
        about: What it takes, where that is not shipped things and files alone.
    """
    what = metavar.lower().replace("|", " or ")
    parser.add_argument(
        "scenario", metavar=metavar, help=about or f"a shipped {what}, or a file"
    )
    parser.add_argument("--robot", metavar="NAME|FILE.xml", help="robot to walk")
    add_trust_argument(parser)
    parser.add_argument("--fields", help="fields to steer with, lifted or paper")
    parser.add_argument("--segments", type=int, metavar="N", help="pieces of the path")
    parser.add_argument(
        "--degree", type=int, metavar="K", help="of the nilpotent approximation"
    )
    parser.add_argument(
        "--words", help="flows of a segment: printed, shortest or symmetric"
    )
    parser.add_argument(
        "--gait",
        metavar="STRATUM",
        nargs="+",
        help="visit the strata in this order again and again, as in 12 1 12 2 12",
    )
    parser.add_argument(
        "--replan",
        action="store_true",
        default=None,
        help="plan each segment from the pose reached",
    )
    parser.add_argument(
        "--steer", help="prediction to steer on: ideal, quasi-static or identified"
    )
    parser.add_argument(
        "--optimise", help="least time, strokes or switches; none if not given"
    )
    parser.add_argument(
        "--allow-unstable",
        action="store_true",
        default=None,
        help="walk plans that are predicted to tip over or to collide",
    )
    add_set_argument(parser, "replace any key of the scenario file")


def add_set_argument(parser: argparse.ArgumentParser, about: str) -> None:
    """Add `--set`, which replaces values one by one.

    Args:
        parser: Parser of the command.
        about: What may be set.
    """
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help=f"{about}; may be repeated",
    )


def scenario_of(options: argparse.Namespace) -> Scenario:
    """The scenario that the command line asks for.

    Raises:
        UsageError: If it cannot be read, or an option contradicts `--set`.
    """
    from sim.scenarios.file import load_scenario, parse_override

    overrides: dict[str, object] = {}
    for key, value in map(parse_override, options.set):
        if key in overrides:
            raise UsageError(f"{key} is given twice", f"--set {key}", "keep one")
        overrides[key] = value
    for key in NAMED:
        value = getattr(options, key, None)
        if value is None:
            continue
        if key in overrides:
            where = f"--{key.replace('_', '-')} and --set {key}"
            raise UsageError(f"{key} is given twice", where, "keep one of them")
        overrides[key] = value
    return load_scenario(options.scenario, overrides)


def folder_of(options: argparse.Namespace) -> Path | None:
    """The folder `--out` names, None if it is left to be numbered.

    Raises:
        UsageError: If the name is empty.
    """
    if options.out == "":
        raise UsageError("an empty name", "--out", "name a folder, or leave --out out")
    return None if options.out is None else Path(options.out)
