"""Accuracy of the planner on every shipped system, as a table for the documentation.

For every system: degree of the approximation, expected and measured order, critical
step, shots to 1e-9, flows, and what CasADi and OMPL need for the same goal where they
are installed (`scripts/peers.py`).

Example:
    python -m scripts.planner_table docs/planner-table.md
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from models import SYSTEMS, Problem, shipped_system
from planner import (
    ExtendedSystem,
    PlannerError,
    convergence_order,
    critical_step,
    extend,
    line,
    plan,
    rollout,
    steer,
)
from scripts.pages import parser_of, tabulate
from scripts.peers import MultipleShooting, Stroke, Task, sampled

COUNTS = (32, 64)  # segments between which the order is measured
HEADER = (
    "system | degree | order expected | measured | critical step | length of the way | "
    "shots to 1e-9 | flows | CasADi | OMPL"
)


def row(name: str) -> tuple[object, ...]:
    """The line of the table for one shipped system."""
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements)
    start, goal = problem.states
    expected = convergence_order(extended, problem.path, "backward")
    exact, step = (
        math.isinf(expected.order),
        critical_step(extended, start, goal - start),
    )
    return (
        name,
        expected.degree,
        "exact" if exact else f"{expected.order:.3g}",
        "exact" if exact else f"{_measured(problem, extended):.2f}",
        "any" if math.isinf(step) else f"{step:.3g}",
        f"{np.linalg.norm(goal - start):.3g}",
        *_shots(problem, extended),
        _peer(Task(problem), lambda task: MultipleShooting(task).once()),
        _peer(Task(problem), sampled),
    )


def _measured(problem: Problem, extended: ExtendedSystem) -> float:
    """The order with which the distance from the goal falls."""
    path = line(*problem.states)
    plans = (plan(extended, path, n, execution=problem.execution) for n in COUNTS)
    misses = [np.linalg.norm(rollout(p)[-1] - problem.states[1]) for p in plans]
    return math.log2(misses[0] / misses[1])


def _shots(problem: Problem, extended: ExtendedSystem) -> tuple[object, object]:
    try:
        free = replace(problem.execution, limits={}, stance="paper")
        steered = steer(extended, *problem.states, free)
    except PlannerError:
        return "none", "none"
    return len(steered.distances) - 1, len(steered.plan.flows)


def _peer(task: Task, solve: Callable[[Task], list[Stroke]]) -> str:
    """Flows of a peer's plan, its distance from the goal, and its time."""
    began = time.perf_counter()
    try:
        strokes = solve(task)
    except ImportError:
        return "not installed"
    took = time.perf_counter() - began
    return f"{len(strokes)}, {task.error(strokes):.0e} off, {took:.1f} s"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, or put it in the place of the one in a file."""
    parser = parser_of(__doc__)
    parser.add_argument("file", type=Path, nargs="?", help="Markdown file with a table")
    tabulate(HEADER, map(row, SYSTEMS), parser.parse_args(arguments).file)


if __name__ == "__main__":
    main()
