"""Changes of a problem that may bring the plan of a system nearer to its goal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from sim.commands.problems import changed, extended, solve

if TYPE_CHECKING:
    from models import Problem
    from sim.planning.remedies import Offer

TIMES = (4, 16)  # as many segments


def helps(problem: Problem, facts: Mapping[str, Any], seconds: float) -> str:
    """What would help a plan that ends far off its goal; empty for others.

    Args:
        problem: What was to be reached.
        facts: Results of its plan.
        seconds: How long trying may take [s].
    """
    from sim.planning.remedies import FAR, tried

    miss = facts["error"] / facts["distance"] if facts["distance"] else 0.0
    return "" if miss <= FAR else str(tried(_offers(problem), miss, seconds))


def _offers(problem: Problem) -> Iterator[Offer]:
    """Changes to try, the cheapest first."""
    degree = extended(problem).steering.degree

    def offer(option: str, aimed: bool = False, **changes: Any) -> Offer:
        other = changed(problem, changes)
        return option, lambda: _miss(other, aimed)

    if problem.words == "printed":
        yield offer("--words symmetric", words="symmetric")
    yield offer(f"--degree {degree + 1}", degree=degree + 1)
    for times in TIMES:
        count = times * problem.segments
        yield offer(f"--segments {count}", segments=count)
    yield offer("--replan", aimed=True)
    start, goal = problem.states
    names = map(str, problem.system.state)
    half = dict(zip(names, ((start + goal) / 2).tolist(), strict=True))
    yield offer("half of the way", goal=half)


def _miss(problem: Problem, aimed: bool) -> float:
    from planner import rollout

    end = rollout(solve(problem, extended(problem), aimed=aimed))[-1]
    start, goal = problem.states
    return math.dist(end, goal) / math.dist(start, goal)
