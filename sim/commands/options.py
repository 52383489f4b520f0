"""What the options of several commands share: settings, robots, folders, extras."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeVar

from sim.errors import ExitCode, UsageError
from sim.scenarios.settings import SETTINGS

if TYPE_CHECKING:
    from models import Robot
    from sim.scenarios.scenario import Scenario

Number = TypeVar("Number", int, float)
Execute = Callable[[argparse.Namespace], ExitCode | None]

NAMED = {
    "robot": "NAME|FILE.xml", "fields": None, "segments": "N", "degree": "K",
    "words": None, "gait": "STRATUM", "replan": None, "steer": None, "optimise": None,
    "allow_unstable": None, "correct": "N", "imperfect": "NAME", "draw": "N",
}  # fmt: skip
"""Settings that have an option of their own, and what stands for the value there."""
OF_RUN = ("correct", "imperfect", "draw")  # options that only `run` has


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
    add_trust_argument(parser)
    for name in (name for name in NAMED if name not in OF_RUN):
        add_setting_argument(parser, name)
    known = f"replace a key of the scenario: {', '.join(SETTINGS)}, path, obstacles"
    add_set_argument(parser, known)


def add_setting_argument(
    parser: argparse.ArgumentParser,
    name: str,
    read: Callable[[str], int] = int,
) -> None:
    """Add the option of a setting; its help is what is declared about the setting.

    Args:
        parser: Parser of the command.
        name: One of `NAMED`.
        read: Reads the value of a whole number.
    """
    declared, option = SETTINGS[name], f"--{name.replace('_', '-')}"
    about = declared.about
    if declared.includes(bool):
        parser.add_argument(option, action="store_true", default=None, help=about)
        return
    if declared.includes(Literal):
        about += f" ({declared.allowed})"
    parser.add_argument(
        option,
        metavar=NAMED[name],
        type=read if declared.includes(int) else str,
        nargs="+" if declared.includes(tuple) else None,
        help=about,
    )


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


def whole(least: int) -> Callable[[str], int]:
    """A reader of whole numbers, for `type` of an option.

    Args:
        least: Smallest that is taken.
    """
    wanted = f"give a whole number, {least} or more"
    return _reader(int, lambda value: value >= least, f"cannot be; {wanted}")


def real(what: str, example: float, zero: bool = True) -> Callable[[str], float]:
    """A reader of finite numbers that are not negative, for `type` of an option.

    Args:
        what: What such a number is.
        example: One that is taken.
        zero: Whether 0 is taken, too.
    """

    def fits(value: float) -> bool:
        return 0 < value < math.inf or (zero and value == 0)

    return _reader(float, fits, f"is not {what}; give a number such as {example:g}")


def _reader(
    make: Callable[[str], Number], fits: Callable[[Number], bool], refusal: str
) -> Callable[[str], Number]:
    def read(text: str) -> Number:
        try:
            value = make(text)
        except ValueError:
            value = make("-1")
        if not fits(value):
            raise argparse.ArgumentTypeError(f"{text} {refusal}")
        return value

    return read


def needs_extra(extra: str) -> Callable[[Execute], Execute]:
    """Have a command say what to install where a package of an extra is missing.

    Args:
        extra: Name of the extra, one of those in pyproject.toml.
    """

    def decorate(execute: Execute) -> Execute:
        @wraps(execute)
        def guarded(options: argparse.Namespace) -> ExitCode | None:
            try:
                return execute(options)
            except ModuleNotFoundError as error:
                if error.name in ("planner", "models", "sim"):
                    raise
                raise UsageError(
                    f"package {error.name!r} is not installed",
                    f"the extra {extra!r}",
                    f"pip install 'stratawalk[{extra}]'",
                ) from error

        return guarded

    return decorate


def add_robot_argument(
    parser: argparse.ArgumentParser,
    about: str,
    metavar: str = "ROBOT",
    optional: bool = False,
) -> None:
    """Add a robot and `--allow-external` to a command that is about one robot."""
    parser.add_argument(
        "robot", metavar=metavar, nargs="?" if optional else None, help=about
    )
    add_trust_argument(parser)


def add_trust_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command that loads robots."""
    parser.add_argument(
        "--allow-external",
        action="store_true",
        help="let a robot's MJCF open files outside its own folder",
    )


def robot_of(options: argparse.Namespace, name: str) -> Robot:
    """Load a robot, and say what it took from elsewhere.

    Raises:
        UnknownRobotError: If there is no such robot or file.
        ModelError: If file or card cannot be used.
    """
    from models import load

    robot = load(name, allow_external=options.allow_external)
    if robot.borrowed:
        print(
            f"stratawalk: notice: {robot.path} has no card; that of the shipped robot "
            f"{robot.borrowed!r}, whose model name it carries, is used",
            file=sys.stderr,
        )
    if robot.external:
        taken = ", ".join(map(str, robot.external))
        print(
            f"stratawalk: notice: taken from outside the folder of {robot.path}: "
            f"{taken}",
            file=sys.stderr,
        )
    return robot
