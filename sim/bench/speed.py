"""Speed and memory, measured side by side in one run, with targets where they exist.

Times are medians, ratios come from interleaved pairs, which affect both sides alike if
the machine changes its speed. Nothing is judged here.
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models import SYSTEMS, equations, load, shipped_robots, shipped_system
from planner import Execution, Plan, degree, extend, hall_basis, line, plan, rollout
from planner.lie import lie_algebra, place, structure_constants
from planner.support import best_so_far, limited, shipped_tables
from sim.optimisation.judging import Judge
from sim.physics.engine import STRETCH
from sim.physics.recording import recorded
from sim.planning.open_loop import plan_open_loop
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup, prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

REPEATS = 5
GENERATORS, ALGEBRA_DEGREE = 4, 5  # of the Lie algebra, 294 elements
SHORT, LONG, HUGE = 60, 1_000, 10_000  # segments
STRIDE = 0.004  # of each segment in x and in y [m]
STEPS = 20_000  # of physics in each measurement: a third of a second
Wanted = tuple[dict[str, Any], float]  # settings of a walk, and most seconds
WALKS: Mapping[str, Wanted] = shipped_tables("sim.bench", "optimised.toml")


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement."""

    what: str
    value: float
    unit: str
    wanted: str | None = None

    def __str__(self) -> str:
        measured = f"{self.what:58}{self.value:12.4g} {self.unit:8}"
        return f"{measured} wanted {self.wanted}" if self.wanted else measured.rstrip()


def paired(
    other: Callable[[], object], ours: Callable[[], object]
) -> tuple[float, float]:
    """Median of other / ours over interleaved pairs, and that of our time [s]."""
    times = [(seconds(other), seconds(ours)) for _ in range(REPEATS)]
    ratios = [a / b for a, b in times]
    return statistics.median(ratios), statistics.median(b for _, b in times)


def median(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median time of some work after one warm-up [s]."""
    work()
    return statistics.median(seconds(work) for _ in range(repeats))


def seconds(work: Callable[[], object]) -> float:
    """Time that some work takes [s]."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def measure() -> Iterator[Row]:
    """All measurements; compilation comes first, before anything is cached."""
    yield from compilation()
    yield algebra()
    yield from plans(prepare(load_scenario("line")))
    for name in SYSTEMS:
        yield from segments(name)
    yield from optimised()
    yield from simulation(prepare(load_scenario("line")))
    yield from command()


def compilation() -> Iterator[Row]:
    """Each shipped system and robot: its equations made and compiled, once."""

    def compiled(kind: str, name: str) -> None:
        made = shipped_system(name) if kind == "system" else equations(load(name))
        extend(made.system, made.elements)

    for kind, names in (("system", SYSTEMS), ("robot", shipped_robots())):
        for name in names:
            took = seconds(partial(compiled, kind, name))
            yield Row(f"{kind} {name} compiled in", took, "s", "< 0.5")


def algebra() -> Row:
    """A Hall basis with its structure constants, from nothing."""

    def structure() -> object:
        for function in (hall_basis, place, degree, structure_constants, lie_algebra):
            function.cache_clear()
        return lie_algebra(hall_basis(GENERATORS, ALGEBRA_DEGREE)).structure

    elements = len(hall_basis(GENERATORS, ALGEBRA_DEGREE))
    what = f"Hall basis of {elements} elements with its structure constants in"
    return Row(what, median(structure), "s", "< 2")


def plans(setup: Setup) -> Iterator[Row]:
    """Plans of the compiled hexapod, centred."""

    def planned(segments: int) -> float:
        far = setup.state(segments * STRIDE * np.array([1.0, 1.0, 0.0]))
        path = line(setup.state(np.zeros(3)), far)
        execution = Execution(stance="centred")
        return median(lambda: plan(setup.extended, path, segments, execution=execution))

    short, long, longest = (planned(n) / n for n in (SHORT, LONG, HUGE))
    yield Row(f"{SHORT} segments planned in", 1e3 * SHORT * short, "ms", "< 5")
    yield Row(f"{HUGE:,} segments planned, each in", 1e6 * longest, "us", "< 100")
    what = f"time for each segment, plans of {HUGE:,} over {LONG:,}"
    yield Row(what, longest / long, "", "near 1")


def segments(name: str, most: int = HUGE) -> Iterator[Row]:
    """Time of a segment of a shipped system, and of a rollout over that of its plan."""
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements)

    def planned(count: int, execution: Execution) -> Plan:
        return plan(extended, problem.path, count, execution=execution)

    each = median(partial(planned, most, problem.open_loop), repeats=2) / most
    yield Row(f"system {name}: {most:,} segments, each in", 1e6 * each, "us", "< 100")
    short = partial(planned, SHORT, problem.execution)  # the words that cost least
    follow = partial(rollout, short())
    follow()
    ratio, _ = paired(follow, short)
    yield Row(f"system {name}: rollout time over plan time", ratio, "", "<= 2")


class _FoundError(Exception):
    """A first plan that keeps its tolerances was found."""


def optimised() -> Iterator[Row]:
    """First plan and whole search for `line`, CPU time; nothing without CasADi."""
    if find_spec("casadi") is None:
        return

    def stop_if_found(stage: str, done: float) -> None:
        if "stages" in best_so_far():
            raise _FoundError

    setup = prepare(load_scenario("line", {"optimise": "time"}))
    began = time.process_time()
    with suppress(_FoundError), limited(600.0):  # [s]
        ScenarioProblem(setup, stop_if_found).solve()
    took = time.process_time() - began
    yield Row("first optimised plan of line, CPU", took, "s", "< 2")
    for name, (changes, most) in WALKS.items():
        setup = prepare(load_scenario("line", changes | {"optimise": "time"}))
        judge, began = Judge(setup), time.process_time()
        problem = ScenarioProblem(setup)
        found = problem.solve().plan
        took = time.process_time() - began
        walk, least = judge.duration(found.flows), problem.least_time
        printed = judge.duration(plan_open_loop(setup).flows)
        what = f"line optimised ({name})"
        yield Row(f"{what}, time", walk, "s", f"<= {most:g}")
        yield Row(f"{what}, least possible", least or 0.0, "s", "> 15")
        yield Row(f"{what}, printed plan over this", printed / walk, "")
        yield Row(f"{what}, CPU", took, "s")


def simulation(setup: Setup) -> Iterator[Row]:
    """The simulate stage against a bare Python loop over the same commands."""
    schedule = scheduled(setup, plan_open_loop(setup).segments())
    ctrl = np.concatenate(list(setup.commands(schedule, STEPS)))

    def staged() -> None:
        pieces = np.split(ctrl, range(STRETCH, STEPS, STRETCH))
        every = setup.scenario.sample_every
        recorded(setup.model, setup.robot, pieces, every, walk_starts=0)

    def bare() -> None:
        data = mujoco.MjData(setup.model)
        mujoco.mj_resetDataKeyframe(setup.model, data, setup.model.key("start").id)
        for row in ctrl:
            data.ctrl[:] = row
            mujoco.mj_step(setup.model, data)

    ratio, took = paired(bare, staged)
    what = "speed of the simulate stage over a bare mj_step loop"
    yield Row(what, ratio, "", ">= 0.9")
    yield Row("physics steps in a second", len(ctrl) / took, "1/s")


def command() -> Iterator[Row]:
    """The command as a process: its response time, and the memory of a run."""

    def python(*words: str) -> Callable[[], object]:
        start = [sys.executable, *words]
        return partial(subprocess.run, start, check=True, stdout=subprocess.DEVNULL)

    took = median(python("-m", "sim.cli", "--help"))
    yield Row("stratawalk --help answers in", took, "s", "< 0.3")
    yield Row("python alone starts in", median(python("-c", "pass")), "s")
    with tempfile.TemporaryDirectory() as folder:
        run = ("-m", "sim.cli", "run", "ellipse", "--no-video", "--out")
        took = seconds(python(*run, str(Path(folder) / "run")))
        yield Row("run ellipse --no-video takes", took, "s")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    yield Row("run ellipse --no-video needs at most", peak, "MB", "< 600")
