"""`stratawalk check`: the controllability of a gait, and what it lacks."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from sim.commands.options import (
    TRUST,
    command,
    option,
    report,
    robot_of,
    set_option,
    settings_of,
    working,
)
from sim.errors import UsageError

if TYPE_CHECKING:
    from planner import Array, Controllability, StratifiedSystem
    from planner.extension import DirectionCost

Loads = Mapping[str, tuple[float, float]]  # by stratum: at rest, and at best


@command(
    "test a system's or robot's gait for controllability (ends with 0 either way)",
    option(
        "system",
        metavar="SYSTEM|ROBOT",
        help="a shipped system or robot, a TOML or Python file, or MJCF with a card",
    ),
    TRUST,
    option(
        "--gait", metavar="STRATUM", nargs="+", help="strata in order, the first again"
    ),
    option(
        "--at", metavar="NAME=VALUE", nargs="+", help="coordinates; else the start's"
    ),
    option("--depth", type=int, metavar="N", help="highest degree of brackets to form"),
    set_option("a parameter of the system"),
)
def check(options: argparse.Namespace) -> None:
    """Test the gait by both criteria of Sec. 4 and print the results."""
    from dataclasses import asdict

    from models.systems import configuration
    from planner import gait_controllability
    from planner.controllability import MAX_DEPTH
    from sim.commands.systems import coordinates, refused

    with working(options, "reading the fields"):
        subject = _subject(options)
    system, gait, start = subject.system, subject.gait, subject.start
    if options.gait:
        gait = _gait(system, options.gait)
    with working(options, "testing the gait"), refused(options.system):
        at = coordinates(options.at or (), "--at")
        found = gait_controllability(
            system,
            gait,
            configuration(system, "--at", at, start).tolist(),
            MAX_DEPTH if options.depth is None else options.depth,
        )
    with working(options, "finding the strokes"):
        costs = _costs(subject, found) if found.controllable else ()
    theory = [cost.direction for cost in costs if cost.in_theory_only]
    facts = asdict(found) | {
        "controllable": found.controllable and not theory,
        "in_theory_only": theory,
        "strokes": {cost.direction: asdict(cost) for cost in costs},
        "static_stability": subject.static_stability,
    }
    lines = [_describe(options.system, found, theory), *_describe_costs(costs)]
    if loads := subject.static_stability:
        shares = (
            f"S{stratum} {max(rest, 0):.2f} at rest, {max(best, 0):.2f} at best"
            for stratum, (rest, best) in loads.items()
        )
        load = f"{'least load':12}{'; '.join(shares)} (share of the weight on a foot)"
        lines.append(load)
    report(options, {"system": options.system, **facts}, *lines)


@dataclass(frozen=True)
class _Subject:
    """What is judged."""

    system: StratifiedSystem
    gait: Sequence[str]
    start: Array | None  # where to look at it; None for the middle
    elements: Sequence[str]  # that it is steered by; none if nobody said
    strokes: Mapping[str, float]  # of a field, 1 for those left out
    static_stability: Loads  # of a robot, the least load on a foot of each stratum


def _costs(subject: _Subject, report: Controllability) -> Sequence[DirectionCost]:
    """What each direction costs in strokes; nothing where that cannot be said."""
    from planner import PlannerError, choose_elements
    from planner.extension import stroke_costs

    system = subject.system
    try:
        elements = subject.elements or choose_elements(system, report.at).elements
        return stroke_costs(system, elements, report.at, subject.strokes)
    except (PlannerError, ValueError):
        return ()


def _gait(system: StratifiedSystem, words: Sequence[str]) -> tuple[str, ...]:
    """Strata by name, written with the S of the paper or without."""
    from planner import Gait, StratumError

    known = system.strata
    bare = [w[1:] if w not in known and w[:1] == "S" else w for w in words]
    try:
        return Gait(system, tuple(bare)).strata
    except StratumError as error:
        raise UsageError.at("--gait", error) from None


def _subject(options: argparse.Namespace) -> _Subject:
    """The system that is named."""
    from models import StaticStability, equations, shipped_robots
    from sim.commands.systems import find, is_system

    source = options.system
    if not source.endswith(".xml") and is_system(source, shipped_robots(), "robot"):
        problem = find(source, settings_of(options))
        start = problem.states[0]
        return _Subject(problem.system, problem.gait, start, problem.elements, {}, {})
    if options.set:
        raise UsageError("a robot has no parameters", "--set", "leave it out")
    robot = robot_of(options, source)
    described, loads = equations(robot), StaticStability(robot).at_rest_and_best()
    elements, strokes = described.elements, described.strokes
    return _Subject(described.system, robot.card.gait, None, elements, strokes, loads)


def _describe(name: str, report: Controllability, theory: Sequence[str] = ()) -> str:
    """The verdict, both tests, and the missing directions, line by line."""
    yes = f"controllable, as the {report.decided_by} shows"
    if theory:
        yes = f"controllable in theory only: no joint range can use {', '.join(theory)}"
    no = "not controllable" if report.conclusive else "not shown to be controllable"
    tests = {
        "filtration": (report.filtration, "brackets within strata alone (Sec. 4)"),
        "closure": (report.closure, "and across strata (Def. 3)"),
    }
    lines = [
        f"{name}: {report.gait}",
        f"{'gait':12}these strata in turn, each named after what is in contact",
        f"{'at':12}{', '.join(f'{value:.6g}' for value in report.at)}",
        f"{'verdict':12}{yes if report.controllable else no}",
        *(
            f"{test:12}rank {rank} of {report.dimension}, {how}"
            for test, (rank, how) in tests.items()
        ),
        f"{'brackets':12}to degree {report.depth}",
    ]
    if not report.controllable:
        lines.append(f"{'missing':12}{', '.join(report.missing)}")
        lines.append(f"{'to do':12}{'; or '.join(report.advice)}")
    return "\n".join(lines)


def _describe_costs(costs: Sequence[DirectionCost]) -> Iterator[str]:
    """What a unit of each direction costs, and which element gives it."""
    if costs:
        yield f"{'strokes':12}over a joint's range each, or a unit of an input without"
    for cost in costs:
        count = f"{cost.strokes:.4g} a unit" if cost.strokes < inf else "never"
        only = ", in theory only" if cost.in_theory_only else ""
        yield f"{'':12}{cost.direction} {count}, by {cost.element}{only}"
