"""Other planners on the hexapod's kinematics: wall time, end error, swing travel.

The stratified planner knows the two tripods as vector fields only; plans that are to
meet the goal are aimed. Joint ranges are left out: swings in the air cost nothing here,
so that a long stroke can be divided as the range requires. Compilation is not timed on
either side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec

import numpy as np

from models import equations, load, shipped_system
from planner import (
    ConvergenceError,
    Execution,
    ExtendedSystem,
    Plan,
    aim,
    extend,
    line,
    plan,
)
from planner.execution import Coordinates
from sim.bench.arcs import Arcs, Stroke, Task, joined, travel
from sim.bench.row import REPEATS, timed

SIDES = {"g1_1": 1, "g2_2": -1}  # fields of the strokes of each tripod
ELEMENTS = (*SIDES, "g1_2", "g2_1", "[g1_1,g2_2]")
GOAL = (0.15, 0.15, 0.0)  # x [m], y [m], yaw [rad], of the scenario `line`
SEGMENTS = 40  # likewise


@dataclass(frozen=True, slots=True)
class Peer:
    """The result of one planner.

    Attributes:
        task: Name of the task.
        planner: Name of the planner.
        seconds: Wall time.
        end_error: Distance from the goal, in the task's unit.
        swing_travel: Of loaded tripods [rad].
        strokes: Number of strokes, between which the feet change; None if infinite.
        over_optimum: Swing travel over that of the optimum; None if it is not known.
    """

    task: str
    planner: str
    seconds: float
    end_error: float
    swing_travel: float
    strokes: int | None
    over_optimum: float | None

    def __str__(self) -> str:
        strokes = "-" if self.strokes is None else self.strokes
        ratio = "-" if self.over_optimum is None else f"{self.over_optimum:.4f}"
        return (
            f"{self.task:22}{self.planner:40}{1e3 * self.seconds:9.2f} ms, "
            f"{self.end_error:7.1e} off, {self.swing_travel:7.3f} rad in {strokes:>3} "
            f"strokes, {ratio:>6} of the optimum"
        )


@dataclass(frozen=True, slots=True)
class Absent:
    """A planner that is not installed, and so has no rows."""

    package: str
    remedy: str = "pip install -e '.[peers]'"

    def __str__(self) -> str:
        return f"{self.package} is not installed, its rows are left out: {self.remedy}"


@dataclass(frozen=True, slots=True)
class Solver:
    """A planner and its task.

    Attributes:
        name: What to call it.
        solve: Gives its strokes.
        repeats: How often to time it; the median counts.
    """

    name: str
    solve: Callable[[], list[Stroke]]
    repeats: int = REPEATS


def measure() -> Iterator[Peer | Absent]:
    """All planners on all tasks, preceded by those that are not installed."""
    present = {name: find_spec(name) is not None for name in ("casadi", "ompl")}
    yield from (Absent(name) for name, found in present.items() if not found)
    for task, extended, segments in tasks():
        optimum = None
        if present["casadi"]:
            optimiser, best = _optimisers(task)
            peer = _measured(task, best, None)
            optimum = peer.swing_travel
            yield replace(peer, over_optimum=1.0)
            yield _measured(task, optimiser, optimum)
        for solver in ours(task, extended, segments):
            yield _measured(task, solver, optimum)
        if present["ompl"]:
            yield _bound(task, optimum)
            for solver in _samplers(task):
                yield _measured(task, solver, optimum)


def tasks() -> Iterator[tuple[Task, ExtendedSystem, int]]:
    """Tasks, the system to plan on, and the number of segments of an open-loop plan."""
    paper = extend(shipped_system("paper-hexapod").system, ELEMENTS)
    yield Task("(1, 1, 0), unit-free", _arcs(paper), (1.0, 1.0, 0.0)), paper, 1
    robot = extend(equations(load("hexapod")).system, ELEMENTS)
    x, y, yaw = GOAL
    one = (x / SEGMENTS, y / SEGMENTS, yaw / SEGMENTS)
    yield Task(f"line, one of {SEGMENTS}", _arcs(robot), one), robot, 1
    yield Task("line, at once", _arcs(robot), GOAL), robot, SEGMENTS


def _arcs(extended: ExtendedSystem) -> Arcs:
    """The arcs of a hexapod's tripod 1."""
    at_rest = np.zeros(extended.system.dimension)
    stride, _, yaw_gain = extended.columns(at_rest)[:3, 0].tolist()
    return Arcs(stride, yaw_gain)


def ours(task: Task, extended: ExtendedSystem, segments: int) -> Iterator[Solver]:
    """Plans in the paper's words and in the shortest, as coarse as can be aimed.

    Args:
        task: What to reach.
        extended: System to plan on.
        segments: Number of pieces of one more plan, open loop along the line.
    """
    goal = np.pad(task.goal, (0, extended.system.dimension - 3))
    path = line(np.zeros_like(goal), goal)
    words: tuple[tuple[str, Coordinates], ...] = (
        ("paper's words", "backward"),
        ("shortest words", "shortest"),
    )
    open_loop = partial(plan, extended, path)
    yield _planner("paper's words, open loop", open_loop, segments)
    for name, coordinates in words:
        execution = Execution(coordinates=coordinates)
        aimed = partial(aim, extended, path, execution=execution)
        yield _planner(f"{name}, aimed", aimed, _fewest(aimed))


def _planner(name: str, planned: Callable[[int], Plan], segments: int) -> Solver:
    name = f"{name}, {segments} segment{'s' * (segments > 1)}"
    return Solver(name, lambda: _strokes(planned(segments)))


def _fewest(planned: Callable[[int], Plan]) -> int:
    """The smallest number of segments that can be aimed."""
    for segments in range(1, SEGMENTS):
        with suppress(ConvergenceError):
            planned(segments)
            return segments
    return SEGMENTS


def _strokes(planned: Plan) -> list[Stroke]:
    flows = (flow for flow in planned.flows if flow.field in SIDES)
    return joined([(SIDES[flow.field], flow.duration) for flow in flows])


def _optimisers(task: Task) -> tuple[Solver, Solver]:
    from sim.bench.casadi_peer import GUESSES, MultipleShooting

    shooting = MultipleShooting(task)
    return (
        Solver("CasADi and IPOPT, one guess", shooting.once),
        Solver(f"CasADi and IPOPT, best of {GUESSES}", shooting.best, repeats=1),
    )


def _samplers(task: Task) -> Iterator[Solver]:
    from sim.bench.ompl_peer import PATIENCE, PLANNERS, sampled

    for planner in PLANNERS:
        name = f"OMPL {planner}, {PATIENCE:.0f} s at most"
        yield Solver(name, partial(sampled, task, planner), repeats=1)


def _bound(task: Task, optimum: float | None) -> Peer:
    from sim.bench.ompl_peer import reeds_shepp

    name = "OMPL, closed form of Reeds and Shepp"
    swing_travel, took = timed(partial(reeds_shepp, task))
    ratio = swing_travel / optimum if optimum else None
    return Peer(task.name, name, took, 0.0, swing_travel, None, ratio)


def _measured(task: Task, solver: Solver, optimum: float | None) -> Peer:
    strokes, took = timed(solver.solve, solver.repeats)
    swept = travel(strokes)
    return Peer(
        task=task.name,
        planner=solver.name,
        seconds=took,
        end_error=task.error(strokes),
        swing_travel=swept,
        strokes=len(strokes),
        over_optimum=swept / optimum if optimum else None,
    )
