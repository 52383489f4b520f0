"""Shipped systems and scenarios, and what names a system on the command line."""

from __future__ import annotations

import argparse
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import command, option, report
from sim.errors import StratawalkError, UsageError

if TYPE_CHECKING:
    from models import Problem

SUFFIXES = (".toml", ".py")


@command(
    "list the shipped scenarios, or print one with all its settings",
    option("scenario", metavar="SCENARIO", nargs="?", help="print this one as TOML"),
)
def scenarios(options: argparse.Namespace) -> None:
    """Print the list, or one scenario."""
    from sim.scenarios.file import dumps, load_scenario, shipped_scenarios, to_table

    if options.scenario:
        one = load_scenario(options.scenario)
        report(options, to_table(one), dumps(one).rstrip())
        return
    all = [load_scenario(name) for name in shipped_scenarios()]
    lines = (f"{s.name:12}{s.segments:4} segments  {s.description}" for s in all)
    report(options, [to_table(scenario) for scenario in all], *lines)


@command(
    "list the shipped systems and their parameters",
    option("system", metavar="SYSTEM", nargs="?", help="one of them; otherwise all"),
)
def systems(options: argparse.Namespace) -> None:
    """Print names, descriptions and parameters."""
    from models import SYSTEMS, shipped_system
    from models.systems import parameters
    from planner.support import did_you_mean

    asked = options.system
    if asked is not None and asked not in SYSTEMS:
        raise UsageError("no such system", asked, did_you_mean(asked, SYSTEMS))
    names = SYSTEMS if asked is None else (asked,)
    facts, lines = [], []
    for name in names:
        of, given = shipped_system(name), parameters(name)
        facts.append(
            {
                "name": name,
                "description": of.description,
                "parameters": given,
                "state": [str(symbol) for symbol in of.system.state],
                "strata": {s: list(fields) for s, fields in of.system.strata.items()},
                "gait": of.gait,
                "elements": of.elements,
                "goal": of.goal,
            }
        )
        lines.append(f"{name:18}{of.description}")
        if pairs := " ".join(f"{k}={json.dumps(v)}" for k, v in given.items()):
            lines.append(f"{'':18}--set {pairs}")
    report(options, facts, *lines)


def is_system(source: str, others: Collection[str], kind: str = "scenario") -> bool:
    """Whether a word means a system and none of the shipped things of another kind."""
    from models import SYSTEMS
    from models.description import parse_toml
    from planner.support import did_you_mean, read_file

    path = Path(source)
    if path.suffix == ".toml" and kind == "scenario":
        with suppress(OSError, ValueError):
            return "strata" in parse_toml(read_file(path).decode())
        return False
    if path.suffix or len(path.parts) > 1 or source in others:
        return path.suffix in SUFFIXES
    if source not in SYSTEMS:
        remedy = did_you_mean(source, [*others, *SYSTEMS])
        raise UsageError(f"unknown {kind} or system {source!r}", kind.upper(), remedy)
    return True


def find(source: str, values: Mapping[str, object]) -> Problem:
    """The problem of a shipped system, or of a TOML or Python file."""
    from models import load_system, shipped_system

    path = Path(source)
    if path.suffix not in SUFFIXES:
        return shipped_system(source, values)
    if not path.is_file():
        raise UsageError("no such system file", source, "give a file that exists")
    return load_system(path, values)


def coordinates(words: Sequence[str], option: str) -> dict[str, float]:
    """Values of coordinates from words `NAME=VALUE`, one of each."""
    values: dict[str, float] = {}
    for word in words:
        name, _, value = (part.strip() for part in word.partition("="))
        if name in values:
            raise UsageError(f"{name} is given twice", option, "keep one of them")
        try:
            values[name] = float(value)
        except ValueError:
            what = f"{word!r} is not a coordinate"
            raise UsageError(what, option, "write NAME=VALUE, as in x=1") from None
    return values


@contextmanager
def refused(where: str) -> Iterator[None]:
    """Turn errors of bad arguments into errors of the command line, word by word."""
    from models import ProblemError

    try:
        yield
    except (StratawalkError, ProblemError):
        raise
    except ValueError as error:
        raise UsageError.at(where, error, "see docs/systems.md") from error
