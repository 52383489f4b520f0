"""Systems and scenarios: those shipped, what names one, and what a gait controls."""

import argparse
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands import options as cli
from sim.errors import StratawalkError, UsageError, message
from sim.interruption import processor_time
from sim.templates import render

if TYPE_CHECKING:
    from models import Problem
    from planner import Array, Controllability, StratifiedSystem
    from planner.extension import DirectionCost

Loads = Mapping[str, tuple[float, float]]  # by stratum: at rest, and at best
SUFFIXES = (".toml", ".py")
READING_TIME = 60.0  # [s] of the processor, for all formulas of a system


def scenarios(options: argparse.Namespace) -> None:
    """Print the list, or one scenario."""
    from sim.scenarios.file import dumps, load_scenario, shipped_scenarios, to_table

    if options.scenario:
        one = load_scenario(options.scenario)
        cli.report(options, to_table(one), dumps(one).rstrip())
        return
    every = [load_scenario(name) for name in shipped_scenarios()]
    lines = (f"{s.name:12}{s.segments:4} segments  {s.description}" for s in every)
    cli.report(options, [to_table(one) for one in every], *lines)


def systems(options: argparse.Namespace) -> None:
    """Print names, descriptions and parameters."""
    from models import SYSTEMS, shipped_system
    from models.systems import parameters
    from planner.support import did_you_mean

    asked = options.system
    if asked is not None and asked not in SYSTEMS:
        remedy = f"{did_you_mean(asked, SYSTEMS)}; `check` and `plan` read files"
        raise UsageError("no such system is shipped", asked, remedy)
    facts, lines = [], []
    for name in SYSTEMS if asked is None else (asked,):
        of, given = shipped_system(name), parameters(name)
        state = [str(symbol) for symbol in of.system.state]
        strata = {s: list(fields) for s, fields in of.system.strata.items()}
        told = {"name": name, "description": of.description, "parameters": given}
        more = {"gait": of.gait, "elements": of.elements, "goal": of.goal}
        facts.append(told | {"state": state, "strata": strata} | more)
        lines += [f"{name:18}{of.description}"]
        lines += [f"{'':18}coordinates {', '.join(state)}"] if asked else []
        if pairs := ", ".join(f"{k}={json.dumps(v)}" for k, v in given.items()):
            lines.append(f"{'':18}parameters {pairs}")
    cli.report(options, facts, *lines)


def is_system(source: str, others: Collection[str], kind: str = "scenario") -> bool:
    """Whether a word means a system and none of the shipped things of another kind."""
    from models import SYSTEMS
    from models.description import parse_toml
    from planner.support import did_you_mean, read_text

    path = Path(source)
    if path.suffix == ".toml" and kind == "scenario":
        with suppress(OSError, ValueError):
            return not {"state", "strata"}.isdisjoint(parse_toml(read_text(path)))
        return False
    if path.suffix or len(path.parts) > 1 or source in others:
        return path.suffix in SUFFIXES
    if source not in SYSTEMS:
        if kind == "robot":
            cli.require_robot(source)
        meant, known = cli.command_for(source, "plan"), [*others, *SYSTEMS]
        remedy = f"try {meant}" if meant else did_you_mean(source, known)
        raise UsageError(f"unknown {kind} or system {source!r}", kind.upper(), remedy)
    return True


def find(source: str, values: Mapping[str, object]) -> "Problem":
    """The problem of a shipped system, or of a TOML or Python file."""
    from models import load_system, shipped_system

    path = Path(source)
    if path.suffix not in SUFFIXES:
        return shipped_system(source, values)
    late = message("slow_system", seconds=READING_TIME)
    with processor_time(READING_TIME, ValueError(late)):
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
            raise UsageError.of("no_value", option, word=word) from None
    return values


@contextmanager
def refused(where: str) -> Iterator[None]:
    """Turn errors of bad arguments into errors of the command line, word by word."""
    from models import ProblemError
    from planner import StratumError

    try:
        yield
    except (StratawalkError, ProblemError):
        raise
    except (ValueError, StratumError) as error:
        raise UsageError.at(where, error, "see docs/systems.md") from error


def check(options: argparse.Namespace) -> None:
    """Test the gait by both criteria of Sec. 4 and print the results."""
    from models.systems import configuration
    from planner import Gait, StratumError, gait_controllability
    from planner.controllability import MAX_DEPTH

    with cli.working(options, "reading the fields"):
        subject = _subject(options)
    system, gait, start = subject.system, subject.gait, subject.start
    try:
        gait = Gait(system, tuple(options.gait or gait)).strata
    except StratumError as error:
        raise UsageError.at("--gait", error) from None
    with cli.working(options, "testing the gait"), refused(options.system):
        at = coordinates(options.at or (), "--at")
        place = configuration(system, "--at", at, start).tolist()
        depth = MAX_DEPTH if options.depth is None else options.depth
        found = gait_controllability(system, gait, place, depth)
    with cli.working(options, "finding the strokes"):
        costs = _costs(subject, found) if found.controllable else ()
    theory = [cost.direction for cost in costs if cost.in_theory_only]
    facts = {
        "system": options.system,
        **asdict(found),
        "controllable": found.controllable and not theory,
        "in_theory_only": theory,
        "strokes": {cost.direction: asdict(cost) for cost in costs},
        "static_stability": subject.static_stability,
        "description": subject.description,
    }
    cli.report(options, facts, render("check.txt", subject=subject, **facts))


@dataclass(frozen=True)
class _Subject:
    """What is judged."""

    description: str
    system: "StratifiedSystem"
    gait: Sequence[str]
    start: "Array | None"  # where to look at it; None for the middle
    elements: Sequence[str]  # that it is steered by; none if nobody said
    strokes: Mapping[str, float]  # of a field, 1 for those left out
    static_stability: Loads  # of a robot, the least load on a foot of each stratum


def _costs(subject: _Subject, found: "Controllability") -> "Sequence[DirectionCost]":
    """What each direction costs in strokes; nothing where that cannot be said."""
    from planner import PlannerError, choose_elements
    from planner.extension import stroke_costs

    system = subject.system
    try:
        elements = subject.elements or choose_elements(system, found.at).elements
        return stroke_costs(system, elements, found.at, subject.strokes)
    except (PlannerError, ValueError):
        return ()


def _subject(options: argparse.Namespace) -> _Subject:
    """The system that is named."""
    from models import StaticStability, equations, shipped_robots

    source = options.system
    if not source.endswith(".xml") and is_system(source, shipped_robots(), "robot"):
        of = find(source, cli.settings_of(options))
        known = of.description, of.system, of.gait
        return _Subject(*known, of.states[0], of.elements, {}, {})
    if options.set:
        raise UsageError("a robot has no parameters", "--set", "leave it out")
    robot = cli.robot_of(options, source)
    described, loads = equations(robot), StaticStability(robot).at_rest_and_best()
    known = robot.card.description, described.system, robot.card.gait
    return _Subject(*known, None, described.elements, described.strokes, loads)
