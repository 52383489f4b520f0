"""Systems of the command line: shipped ones by name, others by file."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models import ProblemError
from models.description import parse_toml
from planner.support import did_you_mean, read_file
from sim.errors import StratawalkError, UsageError
from sim.scenarios.file import parse_override

if TYPE_CHECKING:
    from models import Problem
    from planner import ExtendedSystem, Plan

SUFFIXES = (".toml", ".py")


def is_system(source: str, others: Collection[str], kind: str = "scenario") -> bool:
    """Whether a word of the command line means a system.

    Args:
        source: The word.
        others: Names of the shipped things of the other kind.
        kind: That kind.

    Raises:
        UsageError: It is a name of neither.
    """
    path = Path(source)
    if path.suffix == ".toml":
        return kind != "scenario" or _has_strata(path)
    if path.suffix or len(path.parts) > 1 or source in others:
        return path.suffix == ".py"
    from models import SYSTEMS

    if source not in SYSTEMS:
        remedy = did_you_mean(source, [*others, *SYSTEMS])
        raise UsageError(f"unknown {kind} or system {source!r}", kind.upper(), remedy)
    return True


def _has_strata(path: Path) -> bool:
    try:
        return "strata" in parse_toml(read_file(path).decode())
    except (OSError, ValueError):
        return False


def find(source: str, settings: Sequence[str] = ()) -> Problem:
    """A system and its problem.

    Args:
        source: Name of a shipped system, or path of a TOML or Python file.
        settings: `KEY=VALUE` for parameters that are not to have their defaults.

    Raises:
        UsageError: There is no such file, or a setting sets nothing, or comes twice.
        ProblemError: There is no such system, or its file says something impossible.
    """
    values: dict[str, object] = {}
    for key, value in map(parse_override, settings):
        if key in values:
            raise UsageError(f"{key} is given twice", f"--set {key}", "keep one")
        values[key] = value
    path = Path(source)
    if path.suffix not in SUFFIXES:
        from models import shipped_system

        return shipped_system(source, values)
    if not path.is_file():
        raise UsageError("no such system file", source, "give a file that exists")
    from models import load_system

    return load_system(path, values)


def coordinates(words: Sequence[str], option: str) -> dict[str, float]:
    """Values of coordinates from words `NAME=VALUE`.

    Raises:
        UsageError: A word is not of that form, or a coordinate comes twice.
    """
    values: dict[str, float] = {}
    for word in words:
        name, _, value = (part.strip() for part in word.partition("="))
        if name in values:
            raise UsageError(f"{name} is given twice", option, "keep one of them")
        try:
            values[name] = float(value)
        except ValueError:
            raise UsageError(
                f"{word!r} is not a coordinate", option, "write NAME=VALUE, as in x=1"
            ) from None
    return values


def changed(problem: Problem, changes: Mapping[str, Any]) -> Problem:
    """The problem with other fields, those that are None left as they are.

    Raises:
        UsageError: A change is impossible.
    """
    from planner import StratumError

    with refused(problem.name):
        try:
            given = {name: v for name, v in changes.items() if v is not None}
            return replace(problem, **given)
        except StratumError as error:
            raise ValueError(str(error)) from error


def extended(problem: Problem) -> ExtendedSystem:
    """The extended system, its elements chosen along the path where none are named.

    Raises:
        UsageError: An element is unknown or no element.
        PlannerError: The elements do not serve.
    """
    from planner.planning import extend_along

    with refused(problem.name):
        elements, degree = problem.elements or None, problem.degree
        extended = extend_along(problem.system, elements, problem.path)
        return extended if degree is None else extended.to_degree(degree)


def solve(problem: Problem, compiled: ExtendedSystem, aimed: bool = False) -> Plan:
    """The plan from start to goal.

    Args:
        problem: What to reach.
        compiled: Its extended system.
        aimed: Whether each segment is to end where it should, instead of near it.

    Raises:
        UsageError: The problem asks for the impossible.
        PlannerError: There is no plan.
    """
    from planner import aim, plan
    from planner.planning import plan_between

    with refused(problem.name):
        path, segments = problem.path, problem.segments
        if aimed:
            return aim(compiled, path, segments, problem.execution)
        if lifted(problem):
            return plan_between(compiled, *problem.states, segments, problem.open_loop)
        return plan(compiled, path, segments, execution=problem.open_loop)


def lifted(problem: Problem) -> bool:
    """Whether feet are lifted at the start or at the goal.

    Args:
        problem: What to reach.

    Raises:
        StratumError: An end lies on no stratum.
    """
    from planner.planning import stratum_at

    system = problem.system
    return any(stratum_at(system, x) != system.bottom for x in problem.states)


@contextmanager
def refused(where: str) -> Iterator[None]:
    """Turn errors of bad arguments into errors of the command line.

    Raises:
        UsageError: A `ValueError` came up, with its words.
    """
    try:
        yield
    except (StratawalkError, ProblemError):
        raise
    except ValueError as error:
        raise UsageError.at(where, error, "see docs/systems.md") from error
