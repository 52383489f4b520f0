"""Accuracy of the planner on every shipped system, as a table for the documentation.

For every system: degree of the approximation, expected and measured order, critical
step, shots to 1e-9, flows, and what CasADi and OMPL need for the same goal where they
are installed (`scripts/peers.py`).

Example:
    python -m scripts.planner_table docs/planner-table.md
"""

from __future__ import annotations

import argparse
import math
import sys
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
from scripts.peers import MultipleShooting, Stroke, Task, sampled

COUNTS = (32, 64)  # segments between which the order is measured
HEADER = (
    "system | degree | order expected | measured | critical step | length of the way | "
    "shots to 1e-9 | flows | CasADi | OMPL"
)


def row(name: str) -> str:
    """The line of the table for one system.

    Args:
        name: Name of a shipped system.
    """
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements)
    start, goal = problem.states
    expected = convergence_order(extended, problem.path, "backward")
    cells = [
        name,
        str(expected.degree),
        "exact" if math.isinf(expected.order) else f"{expected.order:.3g}",
        "exact" if math.isinf(expected.order) else _measured(problem, extended),
        _number(critical_step(extended, start, goal - start)),
        f"{np.linalg.norm(goal - start):.3g}",
        *_shots(problem, extended),
        _peer(Task(problem), lambda task: MultipleShooting(task).once()),
        _peer(Task(problem), sampled),
    ]
    return " | ".join(cells)


def _peer(task: Task, solve: Callable[[Task], list[Stroke]]) -> str:
    """Flows of a peer's plan, its distance from the goal, and its time."""
    began = time.perf_counter()
    try:
        strokes = solve(task)
    except ImportError:
        return "not installed"
    took = time.perf_counter() - began
    return f"{len(strokes)}, {task.error(strokes):.0e} off, {took:.1f} s"


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{value:.3g}"


def _measured(problem: Problem, extended: ExtendedSystem) -> str:
    start, goal = problem.states
    misses = [
        np.linalg.norm(
            rollout(plan(extended, line(start, goal), n, execution=problem.execution))[
                -1
            ]
            - goal
        )
        for n in COUNTS
    ]
    return f"{math.log2(misses[0] / misses[1]):.2f}"


def _shots(problem: Problem, extended: ExtendedSystem) -> tuple[str, str]:
    try:
        free = replace(problem.execution, limits={}, stance="paper")
        steered = steer(extended, *problem.states, free)
    except PlannerError:
        return "none", "none"
    return str(len(steered.distances) - 1), str(len(steered.plan.flows))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, or put it in the place of the one in a file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path, nargs="?", help="Markdown file with a table")
    file = parser.parse_args(arguments).file
    titles = HEADER.split(" | ")
    lines = [f"| {HEADER} |", "|" + "---|" * len(titles)]
    for name in SYSTEMS:
        lines.append(f"| {row(name)} |")
        print(lines[-1], file=sys.stderr, flush=True)
    table = "\n".join(lines)
    if file is None:
        print(table)
        return
    prose = file.read_text().splitlines()
    first = next(i for i, text in enumerate(prose) if text.startswith("|"))
    kept = [text for text in prose if not text.startswith("|")]
    file.write_text("\n".join([*kept[:first], table, *kept[first:]]) + "\n")


if __name__ == "__main__":
    main()
