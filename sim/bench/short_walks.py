"""Optimised walks: what they cost to find, and how much shorter they are.

Times are those of the processor, so that other work on the machine does not count.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib.util import find_spec
from typing import Any

from planner.support import best_so_far, limited
from sim.bench.row import Row
from sim.optimisation.judging import Judge
from sim.optimisation.planned import PlannedWalk
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

PATIENCE = 600.0  # [s]
PRINTED = "as near as printed"
Wanted = tuple[dict[str, Any], float]  # settings of a walk, and most seconds
WALKS: Mapping[str, Wanted] = {
    PRINTED: ({}, 82.0),
    "together": ({"overlap_recovery": True}, 57.0),
    "10 mm, yaw free, together": (
        {"together": True, "path_tolerance": 0.01, "yaw_tolerance": 3.2},
        28.0,
    ),
}


class _FoundError(Exception):
    """A first plan was found."""


def measure() -> Iterator[Row]:
    """The first plan and all of the search for `line`; nothing without CasADi."""
    if find_spec("casadi") is None:
        return
    yield Row("first optimised plan of line, CPU", _first(), "s", "< 2")
    for name, (changes, most) in WALKS.items():
        setup = prepare(load_scenario("line", changes | {"optimise": "time"}))
        judge, began = Judge(setup), time.process_time()
        found = PlannedWalk(setup).plan()
        took = time.process_time() - began
        seconds = judge.duration(found.flows)
        printed = judge.duration(plan_open_loop(setup).flows)
        yield Row(f"line optimised ({name}), time", seconds, "s", f"<= {most:g}")
        yield Row(f"line optimised ({name}), printed over it", printed / seconds, "")
        yield Row(f"line optimised ({name}), CPU", took, "s")


def _first() -> float:
    """Processor time until there is a plan that keeps its tolerances [s]."""
    setup = prepare(load_scenario("line", {"optimise": "time"}))
    began = time.process_time()
    with suppress(_FoundError), limited(PATIENCE):
        PlannedWalk(setup, _stop_if_found).plan()
    return time.process_time() - began


def _stop_if_found(stage: str, done: float) -> None:
    if "stages" in best_so_far():
        raise _FoundError
