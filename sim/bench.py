"""Speed and memory, measured side by side in one run; every claim with what was wanted.

Ratios are medians of interleaved pairs, so that a machine that speeds up or slows down
meanwhile disturbs both sides alike. Judges nothing: a slow machine is not an error.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from planner.extended import extend
from planner.paths import line
from planner.plan import plan
from sim.measure import Sensors
from sim.physics import Engine
from sim.planning import plan_open_loop
from sim.recording import Recorder
from sim.scenario_file import load
from sim.schedule import Scheduler
from sim.setup import Setup, prepare
from sim.walk import lay

PAIRS = 5
STEPS = 20_000  # of physics in each measurement: a third of a second


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement."""

    what: str
    value: float
    unit: str
    wanted: str

    def __str__(self) -> str:
        return f"{self.what:58}{self.value:12.4g} {self.unit:8} wanted {self.wanted}"


def measure() -> Iterator[Row]:
    """All measurements, one after another."""
    setup = prepare(load("line"))
    yield from simulation(setup)
    yield from planning(setup)
    yield from command()


def simulation(setup: Setup) -> Iterator[Row]:
    """The simulate stage against a bare Python loop over the same commands."""
    scheduler = Scheduler(setup.limits, setup.at_rest)
    lay(setup, scheduler, plan_open_loop(setup).segments())
    ctrl = setup.channels.ctrl(*scheduler.finish().angles())[:STEPS]

    def staged() -> None:
        recorder = Recorder(
            Engine(setup.model),
            Sensors(setup.model, setup.robot),
            setup.scenario.sample_every,
        )
        for _ in recorder.play(ctrl):
            pass
        recorder.finish()

    def bare() -> None:
        data = mujoco.MjData(setup.model)
        mujoco.mj_resetDataKeyframe(setup.model, data, setup.model.key("start").id)
        for row in ctrl:
            data.ctrl[:] = row
            mujoco.mj_step(setup.model, data)

    ratio, seconds = paired(bare, staged)
    yield Row(
        "speed of the simulate stage over a bare mj_step loop", ratio, "", ">= 0.9"
    )
    yield Row("physics steps in a second", len(ctrl) / seconds, "1/s", "")


def planning(setup: Setup) -> Iterator[Row]:
    """Planning after compilation, and compilation itself."""

    def segments(count: int) -> float:
        far = setup.state(np.array([0.004 * count, 0.004 * count, 0.0]))
        path = line(setup.state(np.zeros(3)), far)
        return median(lambda: plan(setup.extended, path, count, stance="centred"))

    described = setup.equations
    sixty, many = segments(60), segments(10_000)
    yield Row("60 segments planned in", 1e3 * sixty, "ms", "< 50")
    yield Row("10,000 segments planned, each in", 1e6 * many / 10_000, "us", "< 100")
    compiling = median(lambda: extend(described.system, described.elements), 3)
    yield Row("the hexapod's equations compiled in", compiling, "s", "< 0.5")


def command() -> Iterator[Row]:
    """The command from outside: time to answer, memory of a run."""
    start = [sys.executable, "-m", "sim.cli"]

    def answer() -> None:
        subprocess.run([*start, "--help"], check=True, stdout=subprocess.DEVNULL)

    def nothing() -> None:
        subprocess.run([sys.executable, "-c", "pass"], check=True)

    yield Row("stratawalk --help answers in", median(answer), "s", "< 0.3")
    yield Row("python alone starts in", median(nothing), "s", "")
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "run")
        began = time.perf_counter()
        subprocess.run(
            [*start, "run", "ellipse", "--no-video", "--out", out],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        yield Row("run ellipse --no-video takes", time.perf_counter() - began, "s", "")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    yield Row("and at most this much memory", peak, "MB", "< 600")


def paired(other: Callable[[], None], ours: Callable[[], None]) -> tuple[float, float]:
    """Median of other / ours over interleaved pairs, and that of our time [s]."""
    times = [(_seconds(other), _seconds(ours)) for _ in range(PAIRS)]
    ratios = [a / b for a, b in times]
    return statistics.median(ratios), statistics.median(b for _, b in times)


def median(work: Callable[[], object], repeats: int = PAIRS) -> float:
    """Median time of some work after one warm-up [s]."""
    work()
    return statistics.median(_seconds(work) for _ in range(repeats))


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began
