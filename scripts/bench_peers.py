"""Other planners on the hexapod's kinematics: wall time, end error, swing travel.

A loaded tripod swings the body along a circle, tripod 1 to the left and tripod 2 to the
right, forward and back; legs in the air may swing at no cost. So the task is a system
of two fields in the plane, and the cost of a plan is the angle swept. Joint ranges are
left out: a long stroke can be divided as the range requires. Compilation is not timed.

Example:
    python -m scripts.bench_peers
"""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np

from models import equations, load, load_system, shipped_system
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
from scripts.pages import parser_of
from scripts.peers import (
    GUESSES,
    SAMPLING_TIME,
    MultipleShooting,
    Stroke,
    Task,
    joined,
    reeds_shepp,
    sampled,
    travel,
)

TRIPODS = ("g1_1", "g2_2")  # fields of the strokes of each tripod
ELEMENTS = (*TRIPODS, "g1_2", "g2_1", "[g1_1,g2_2]")
GOAL = (0.15, 0.15, 0.0)  # x [m], y [m], yaw [rad], of the scenario `line`
SEGMENTS = 40  # likewise
SYSTEM = """
state = ["x", "y", "yaw"]
elements = ["g1_1", "g2_2", "[g1_1,g2_2]"]
goal = {{ x = {x!r}, y = {y!r}, yaw = {yaw!r} }}
[parameters]
stride = {stride!r}
gain = {yaw_gain!r}
[strata.0]
g1_1 = {{ x = "stride*cos(yaw)", y = "stride*sin(yaw)", yaw = "gain" }}
g2_2 = {{ x = "stride*cos(yaw)", y = "stride*sin(yaw)", yaw = "-gain" }}
"""
SAMPLERS = ("RRT", "EST", "KPIECE1")
REPEATS = 5
Result = TypeVar("Result")
Solver = tuple[str, Callable[[], list[Stroke]], int]
"""What a planner is called, what plans, and how often it is timed."""


@dataclass(frozen=True, slots=True)
class Peer:
    """The result of one planner."""

    task: str
    planner: str
    seconds: float  # wall time
    end_error: float  # distance from the goal, in the task's unit
    swing_travel: float  # of loaded tripods [rad]
    strokes: int | None  # between which the feet change; None if infinitely many
    over_optimum: float  # swing travel over the least

    def __str__(self) -> str:
        strokes = "-" if self.strokes is None else self.strokes
        return (
            f"{self.task:22}{self.planner:40}{1e3 * self.seconds:9.2f} ms, "
            f"{self.end_error:7.1e} off, {self.swing_travel:7.3f} rad in {strokes:>3} "
            f"strokes, {self.over_optimum:.4f} of the optimum"
        )


def measure() -> Iterator[Peer]:
    """All planners on all tasks."""
    for task, hexapod, segments in tasks():
        shooting = MultipleShooting(task)
        optimum = travel(shooting.best())
        solvers: list[Solver] = [
            (f"CasADi and IPOPT, best of {GUESSES}", shooting.best, 1),
            ("CasADi and IPOPT, one guess", shooting.once, REPEATS),
            *ours(task, hexapod, segments),
        ]
        for planner in SAMPLERS:
            name = f"OMPL {planner}, {SAMPLING_TIME:.0f} s at most"
            solvers.append((name, partial(sampled, task, planner), 1))
        name = task.problem.name
        for planner, solve, repeats in solvers:
            strokes, took = timed(solve, repeats)
            swept, off = travel(strokes), task.error(strokes)
            yield Peer(name, planner, took, off, swept, len(strokes), swept / optimum)
        swept, took = timed(partial(bound, task), 1)
        planner = "OMPL, closed form of Reeds and Shepp"
        yield Peer(name, planner, took, 0.0, swept, None, swept / optimum)


def timed(solve: Callable[[], Result], repeats: int) -> tuple[Result, float]:
    """A result, and the median of the times that it takes [s]."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        found = solve()
        times.append(time.perf_counter() - began)
    return found, statistics.median(times)


def tasks() -> Iterator[tuple[Task, ExtendedSystem, int]]:
    """Tasks, the whole hexapod, and the number of segments of an open-loop plan."""
    paper = extend(shipped_system("paper-hexapod").system, ELEMENTS)
    yield strokes_to("(1, 1, 0), unit-free", paper, (1.0, 1.0, 0.0)), paper, 1
    robot = extend(equations(load("hexapod")).system, ELEMENTS)
    one = tuple(value / SEGMENTS for value in GOAL)
    yield strokes_to(f"line, one of {SEGMENTS}", robot, one), robot, 1
    yield strokes_to("line, at once", robot, GOAL), robot, SEGMENTS


def strokes_to(name: str, hexapod: ExtendedSystem, goal: Sequence[float]) -> Task:
    """The task of reaching x, y and yaw [rad] by strokes of a hexapod's tripods."""
    at_rest = np.zeros(hexapod.system.dimension)
    stride, _, yaw_gain = hexapod.columns(at_rest)[:3, 0].tolist()
    x, y, yaw = goal
    with TemporaryDirectory() as folder:
        file = Path(folder) / "strokes.toml"
        file.write_text(
            SYSTEM.format(x=x, y=y, yaw=yaw, stride=stride, yaw_gain=yaw_gain)
        )
        problem = replace(load_system(file), name=name)
    radius = stride / yaw_gain
    return Task(problem, units=(radius, radius, 1.0), rounds=4)


def bound(task: Task) -> float:
    """Lower bound on the swing travel of all plans [rad].

    The paths of Reeds and Shepp may also go straight, which both tripods approach by
    ever smaller strokes.
    """
    system, (_, goal) = task.problem.system, task.problem.states
    stride = float(system.compiled(TRIPODS[0]).velocity(np.zeros(3))[0])
    return reeds_shepp(goal.tolist(), float(task.scale[0])) / stride


def ours(task: Task, hexapod: ExtendedSystem, segments: int) -> Iterator[Solver]:
    """Plans in the paper's words and in the shortest, as coarse as can be aimed.

    They are made on the whole hexapod, one of them in some segments and open loop.
    """
    goal = np.pad(task.problem.states[1], (0, hexapod.system.dimension - 3))
    path = line(np.zeros_like(goal), goal)
    ways: tuple[tuple[str, Coordinates], ...] = (
        ("paper's words", "backward"),
        ("shortest words", "shortest"),
    )

    def solver(name: str, planned: Callable[[int], Plan], count: int) -> Solver:
        def strokes() -> list[Stroke]:
            flows = planned(count).flows
            return joined((f.field, f.duration) for f in flows if f.field in TRIPODS)

        return f"{name}, {count} segment{'s' * (count > 1)}", strokes, REPEATS

    yield solver("paper's words, open loop", partial(plan, hexapod, path), segments)
    for name, coordinates in ways:
        execution = Execution(coordinates=coordinates)
        aimed = partial(aim, hexapod, path, execution=execution)
        yield solver(f"{name}, aimed", aimed, _fewest(aimed))


def _fewest(planned: Callable[[int], Plan]) -> int:
    """The smallest number of segments that can be aimed."""
    for segments in range(1, SEGMENTS):
        with suppress(ConvergenceError):
            planned(segments)
            return segments
    return SEGMENTS


def main(arguments: Sequence[str] | None = None) -> None:
    """Print every row when it is measured, or all of them as JSON."""
    parser = parser_of(__doc__)
    parser.add_argument("--json", action="store_true", help="print JSON")
    if parser.parse_args(arguments).json:
        print(json.dumps([asdict(row) for row in measure()], indent=1))
        return
    for row in measure():
        print(row, flush=True)


if __name__ == "__main__":
    main()
