"""How commands are declared, and what they share: settings, robots, folders, words."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from math import inf
from operator import methodcaller
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeVar

from sim.endings import again
from sim.errors import ExitCode, SimulationError, UsageError, one_line, printable
from sim.progress import bar, stage
from sim.scenarios.settings import SETTINGS

if TYPE_CHECKING:
    from models import Robot
    from sim.scenarios.scenario import Scenario

Number = TypeVar("Number", int, float)
Execute = Callable[[argparse.Namespace], ExitCode | None]
Option = Callable[[argparse.ArgumentParser], object]
"""Adds an option to the parser of a command."""

NAMED = {
    "robot": "NAME|FILE.xml", "fields": None, "segments": "N", "degree": "K",
    "words": None, "gait": "STRATUM", "replan": None, "steer": None, "optimise": None,
    "allow_unstable": None, "correct": "N", "imperfect": "NAME", "draw": "N",
}  # fmt: skip
"""Settings that have an option of their own, and what stands for the value there."""
SIZES = 1e-6, 1e9  # of numbers in options
OF_RUN = ("correct", "imperfect", "draw")  # options that only `run` has


@dataclass(frozen=True)
class Command:
    """A command, named as the function that executes it."""

    help: str
    options: Sequence[Option]
    execute: Execute
    extra: str  # of pyproject.toml, which has packages that it needs; empty for none
    epilog: str | None

    def __call__(self, options: argparse.Namespace) -> ExitCode | None:
        """Execute it; a package that is missing is said with the extra it is of."""
        try:
            return self.execute(options)
        except ModuleNotFoundError as error:
            if not self.extra or error.name in ("planner", "models", "sim"):
                raise
            what, where = f"package {error.name!r} is not installed", repr(self.extra)
            remedy = f"pip install 'stratawalk[{self.extra}]'"
            raise UsageError(what, f"the extra {where}", remedy) from error


def command(
    about: str, *options: Option, extra: str = "", epilog: str | None = None
) -> Callable[[Execute], Command]:
    """Declare the function below as a command with these options."""
    return lambda execute: Command(about, options, execute, extra, epilog)


def option(*names: str, **declared: object) -> Option:
    """An option as `argparse` declares it, for `command`."""
    return methodcaller("add_argument", *names, **declared)


def flag(name: str, about: str) -> Option:
    """An option without a value, which is off unless it is given."""
    return option(name, action="store_true", help=about)


def switch(name: str, about: str, default: bool | None = None) -> Option:
    """An option that `--no-` before its name turns off."""
    action = argparse.BooleanOptionalAction
    return option(name, action=action, default=default, help=about)


def set_option(about: str) -> Option:
    """`--set`, which replaces values one by one."""
    return option(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help=f"{about}; may be repeated",
    )


def setting_option(name: str, read: Callable[[str], int] = int) -> Option:
    """The option of a setting in `NAMED`; its help is what is declared about it."""
    declared, flag = SETTINGS[name], f"--{name.replace('_', '-')}"
    if declared.includes(bool):
        return option(flag, action="store_true", default=None, help=declared.about)
    choices = f" ({declared.allowed})" if declared.includes(Literal) else ""
    return option(
        flag,
        metavar=NAMED[name],
        type=read if declared.includes(int) else str,
        nargs="+" if declared.includes(tuple) else None,
        help=declared.about + choices,
    )


TRUST = flag("--allow-external", "let a robot's MJCF open files outside its own folder")
RUN = option(
    "run",
    metavar="RUN",
    nargs="?",
    default="runs",
    help="folder of a finished run; the newest one in `runs` if left out",
)
LOOK = option(
    "--look", choices=("draft", "final"), default="draft", help="look of the film"
)


def scenario_options(metavar: str = "SCENARIO", about: str = "") -> list[Option]:
    """What selects a scenario and replaces its settings."""
    about = about or f"a shipped {metavar.lower().replace('|', ' or ')}, or a file"
    known = f"replace a key of the scenario: {', '.join(SETTINGS)}, path, obstacles"
    return [
        option("scenario", metavar=metavar, help=about),
        TRUST,
        *(setting_option(name) for name in NAMED if name not in OF_RUN),
        set_option(known),
    ]


def robot_options(
    about: str, metavar: str = "ROBOT", nargs: str | None = None
) -> list[Option]:
    """What a command has that is about one robot."""
    return [option("robot", metavar=metavar, nargs=nargs, help=about), TRUST]


def scenario_of(options: argparse.Namespace) -> Scenario:
    """The scenario that the command line asks for.

    Raises:
        UsageError: If it cannot be read, or an option contradicts `--set`.
    """
    from sim.scenarios.file import load_scenario

    overrides = settings_of(options)
    for key in NAMED:
        value = getattr(options, key, None)
        if value is None:
            continue
        if key in overrides:
            where = f"--{key.replace('_', '-')} and --set {key}"
            raise UsageError(f"{key} is given twice", where, "keep one of them")
        overrides[key] = value
    return load_scenario(options.scenario, overrides)


def settings_of(options: argparse.Namespace) -> dict[str, object]:
    """What `--set` sets; a key that comes twice is refused."""
    from sim.scenarios.file import parse_override

    values: dict[str, object] = {}
    for key, value in map(parse_override, options.set):
        if key in values:
            raise UsageError(f"{key} is given twice", f"--set {key}", "keep one")
        values[key] = value
    return values


def folder_of(options: argparse.Namespace) -> Path | None:
    """The folder `--out` names, which is not empty; None if it is to be numbered."""
    if options.out == "":
        raise UsageError("an empty name", "--out", "name a folder, or leave --out out")
    return None if options.out is None else Path(options.out)


def run_of(options: argparse.Namespace) -> Path:
    """The run that is asked for: the newest, where a folder holds runs.

    A folder of runs that has none is a UsageError.
    """
    folder = Path(options.run)
    ended = list(folder.glob("*/summary.json"))
    holds_runs = folder == Path("runs") or ended
    if (folder / "scenario.toml").exists() or not holds_runs:
        return folder
    if not ended:
        raise UsageError("no run here", str(folder), "walk one: stratawalk run line")
    run = max(ended, key=lambda file: file.stat().st_mtime).parent
    notice(f"the newest run, {run}")
    return run


def kept_in(folder: Path, out: str | None) -> str:
    """What a folder keeps of work that ends early, and the command that does it anew.

    `out` is the name that `--out` gave it; the empty folder itself will be removed.
    """
    there = sorted(path.name for path in folder.glob("[!.]*"))
    if not there:
        return f"nothing is kept, start again: {again()}"
    on = again(*elsewhere(out))
    return f"{folder} keeps {', '.join(there)}, start again: {on}"


def elsewhere(out: str | None) -> list[str]:
    """Words that name another place than the one that `--out` named, which is taken."""
    if not out:
        return []
    taken = Path(out)
    names = (f"{taken.stem}-{number}{taken.suffix}" for number in count(2))
    free = (path for path in map(taken.with_name, names) if not os.path.lexists(path))
    return ["--out", str(next(free))]


def whole(least: int, most: float = inf) -> Callable[[str], int]:
    """A reader of whole numbers between two, or from one on, for an option's `type`."""
    wanted = f"{least} or more" if most == inf else f"{least} to {most}"
    refusal = f"cannot be; give a whole number, {wanted}"
    return _reader(int, lambda value: least <= value <= most, refusal)


def real(what: str, example: float, zero: bool = True) -> Callable[[str], float]:
    """A reader of positive numbers of no odd size, or zero, for `type` of an option.

    A refusal says what such a number is, and gives an example.
    """

    def fits(value: float) -> bool:
        return SIZES[0] <= value <= SIZES[1] or (zero and value == 0)

    return _reader(float, fits, f"is not {what}; give a number such as {example:g}")


def _reader(
    make: type[Number], fits: Callable[[Number], bool], refusal: str
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


def robot_of(options: argparse.Namespace, name: str) -> Robot:
    """Load a robot, and say what it took from elsewhere."""
    from models import load

    robot = load(name, allow_external=options.allow_external)
    if robot.borrowed:
        notice(
            f"{robot.path} has no card; that of the shipped robot {robot.borrowed!r}, "
            "whose model name it carries, is used"
        )
    if robot.opened.external:
        taken = ", ".join(map(str, robot.opened.external))
        notice(f"taken from outside the folder of {robot.path}: {taken}")
    return robot


def report(options: argparse.Namespace, facts: object, *lines: object) -> None:
    """Print facts as JSON alone where that is asked for, and lines elsewhere."""
    found = json.dumps(facts, indent=1) if options.json else "\n".join(map(str, lines))
    print(printable(found))


@contextmanager
def working(options: argparse.Namespace, on: str) -> Iterator[None]:
    """Show a stage of the work for as long as the block runs."""
    with bar(quiet=options.json) as progress, stage(progress, on):
        yield


def notice(text: str, kind: str = "notice") -> None:
    """Print what a user should know on standard error."""
    line = printable(" ".join(text.split()))
    print(f"stratawalk: {kind}: {line}", file=sys.stderr)


def ended(code: ExitCode, how: str, where: str, remedy: str) -> ExitCode:
    """Print why a walk does not end the command with 0, and return its code."""
    notice(one_line(SimulationError(how, where, remedy)), "error")
    return code
