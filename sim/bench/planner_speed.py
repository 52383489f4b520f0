"""Speed of the planner: its algebra, its compilation, plans short and long.

The cost of plans is measured as well: swing travel under load of the shortest words and
of the printed ones, on the shipped scenarios.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from models import SYSTEMS, equations, load, shipped_robots, shipped_system
from planner import (
    Execution,
    ExtendedSystem,
    Plan,
    aim,
    degree,
    extend,
    hall_basis,
    line,
    merged,
    plan,
    rollout,
)
from planner.execution import Coordinates
from planner.lie import lie_algebra, place, structure_constants
from sim.bench.row import Row, median, paired, seconds
from sim.preparation.setup import Setup, prepare
from sim.scenarios.file import load_scenario

GENERATORS, DEGREE = 4, 5  # of the Lie algebra, 294 elements
SHORT, LONG, LONGEST = 60, 1_000, 10_000  # segments
REPEATS_LONGEST = 2
STRIDE = 0.004  # of each segment in x and in y [m]
SCENARIOS = ("line", "ellipse", "diagonal")


def measure() -> Iterator[Row]:
    """All measurements; compilation comes first, before anything is cached."""
    yield from compilation()
    yield from algebra()
    yield from plans(prepare(load_scenario("line")))
    for name in SYSTEMS:
        yield from segments(name)
    for name in SCENARIOS:
        yield from travel(name)


def compilation() -> Iterator[Row]:
    """Each shipped system and robot: its equations made and compiled, once."""
    for kind, names in (("system", SYSTEMS), ("robot", shipped_robots())):
        for name in names:
            took = seconds(partial(_compiled, kind, name))
            yield Row(f"{kind} {name} compiled in", took, "s", "< 0.5")


def _compiled(kind: str, name: str) -> ExtendedSystem:
    if kind == "system":
        problem = shipped_system(name)
        return extend(problem.system, problem.elements)
    described = equations(load(name))
    return extend(described.system, described.elements)


def algebra() -> Iterator[Row]:
    """A Hall basis with its structure constants, from nothing."""
    remembered = (hall_basis, place, degree, structure_constants, lie_algebra)

    def structure() -> object:
        for function in remembered:
            function.cache_clear()
        return lie_algebra(hall_basis(GENERATORS, DEGREE)).structure

    elements = len(hall_basis(GENERATORS, DEGREE))
    what = f"Hall basis of {elements} elements with its structure constants in"
    yield Row(what, median(structure), "s", "< 2")


def plans(setup: Setup) -> Iterator[Row]:
    """Plans of the compiled hexapod, centred."""

    def planned(segments: int) -> float:
        far = setup.state(segments * STRIDE * np.array([1.0, 1.0, 0.0]))
        path = line(setup.state(np.zeros(3)), far)
        execution = Execution(stance="centred")
        return median(lambda: plan(setup.extended, path, segments, execution=execution))

    short, long, longest = (planned(n) / n for n in (SHORT, LONG, LONGEST))
    yield Row(f"{SHORT} segments planned in", 1e3 * SHORT * short, "ms", "< 5")
    yield Row(f"{LONGEST:,} segments planned, each in", 1e6 * longest, "us", "< 100")
    what = f"time of each segment, {LONGEST:,} over {LONG:,}"
    yield Row(what, longest / long, "", "near 1")


def segments(name: str, most: int = LONGEST) -> Iterator[Row]:
    """Time of a segment of a shipped system, and of a rollout over that of its plan."""
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements)

    def planned(count: int, execution: Execution) -> Plan:
        return plan(extended, problem.path, count, execution=execution)

    long = partial(planned, most, problem.open_loop)
    each = median(long, REPEATS_LONGEST) / most
    yield Row(f"system {name}: {most:,} segments, each in", 1e6 * each, "us", "< 100")
    short = partial(planned, SHORT, problem.execution)  # the words that cost least
    follow = partial(rollout, short())
    follow()
    ratio, _ = paired(follow, short)
    yield Row(f"system {name}: a rollout over its plan", ratio, "", "<= 2")


def travel(scenario: str) -> Iterator[Row]:
    """Swing travel under load of the shortest words over that of the printed ones."""
    setup = prepare(load_scenario(scenario))

    def swept(coordinates: Coordinates) -> float:
        """Of a plan that ends exactly at the goal [rad]."""
        execution = Execution(stance=setup.stance, coordinates=coordinates)
        segments = setup.scenario.segments
        aimed = aim(setup.extended, setup.nominal(), segments, execution)
        loaded = setup.extended.elements[:2]
        return sum(abs(f.duration) for f in merged(aimed.flows) if f.field in loaded)

    what = f"{scenario}: swing travel of shortest words over the printed"
    yield Row(what, swept("shortest") / swept("backward"), "", "< 1")
