"""Speed and memory, measured side by side in one run, with targets where they exist.

The simulation against a bare loop, the planner, and the command as a whole.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from planner.support import best_so_far, limited
from sim.bench import planner_speed
from sim.bench.row import Row, median, paired, seconds
from sim.optimisation.judging import Judge
from sim.physics.engine import STRETCH, Engine
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder
from sim.planning.open_loop import plan_open_loop
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup, prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

STEPS = 20_000  # of physics in each measurement: a third of a second
FIRST_PLAN_LIMIT = 600.0  # [s]
Wanted = tuple[dict[str, Any], float]  # settings of a walk, and most seconds
WALKS: Mapping[str, Wanted] = {
    "19 mm and 0.17 rad": ({"path_tolerance": 0.019, "yaw_tolerance": 0.17}, 72.5),
    "overlapped recovery": ({"overlap_recovery": True}, 57.0),
    "10 mm, yaw free, overlapped recovery": (
        {"overlap_recovery": True, "path_tolerance": 0.01, "yaw_tolerance": 3.2},
        28.0,
    ),
}


def measure() -> Iterator[Row]:
    """All measurements, one after another."""
    yield from planner_speed.measure()
    yield from optimised()
    yield from simulation(prepare(load_scenario("line")))
    yield from command()


class _FoundError(Exception):
    """A first plan that keeps its tolerances was found."""


def optimised() -> Iterator[Row]:
    """The first plan and all of the search for `line`; nothing without CasADi.

    Times are those of the processor, so that other work on the machine does not count.
    """
    if find_spec("casadi") is None:
        return
    setup = prepare(load_scenario("line", {"optimise": "time"}))
    began = time.process_time()
    with suppress(_FoundError), limited(FIRST_PLAN_LIMIT):
        ScenarioProblem(setup, _stop_if_found).solve()
    took = time.process_time() - began
    yield Row("first optimised plan of line, CPU", took, "s", "< 2")
    for name, (changes, most) in WALKS.items():
        setup = prepare(load_scenario("line", changes | {"optimise": "time"}))
        judge, began = Judge(setup), time.process_time()
        problem = ScenarioProblem(setup)
        found = problem.solve().plan
        took = time.process_time() - began
        seconds, least = judge.duration(found.flows), problem.least_time or 0.0
        printed = judge.duration(plan_open_loop(setup).flows)
        yield Row(f"line optimised ({name}), time", seconds, "s", f"<= {most:g}")
        yield Row(f"line optimised ({name}), least possible", least, "s", "> 15")
        yield Row(f"line optimised ({name}), printed over it", printed / seconds, "")
        yield Row(f"line optimised ({name}), CPU", took, "s")


def _stop_if_found(stage: str, done: float) -> None:
    if "stages" in best_so_far():
        raise _FoundError


def simulation(setup: Setup) -> Iterator[Row]:
    """The simulate stage against a bare Python loop over the same commands."""
    schedule = scheduled(setup, plan_open_loop(setup).segments())
    ctrl = np.concatenate(list(setup.commands(schedule, STEPS)))

    def staged() -> None:
        sensors = Sensors(setup.model, setup.robot)
        every = setup.scenario.sample_every
        recorder = Recorder(Engine(setup.model), sensors, every)
        recorder.walk_starts = 0
        for _ in recorder.play(np.split(ctrl, range(STRETCH, STEPS, STRETCH))):
            pass
        recorder.finish()

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
    yield Row("and at most this much memory", peak, "MB", "< 600")
