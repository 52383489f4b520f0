"""Speed and memory, measured side by side in one run, with targets where they exist.

The simulation against a bare loop, the planner, and the command as a whole.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from sim.bench import planner_speed, short_walks
from sim.bench.row import Row, median, paired, seconds
from sim.motion.schedule import Scheduler
from sim.physics.engine import STRETCH, Engine
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder
from sim.planning.open_loop import plan_open_loop
from sim.preparation.scheduling import schedule_flows
from sim.preparation.setup import Setup, prepare
from sim.scenarios.file import load_scenario

STEPS = 20_000  # of physics in each measurement: a third of a second


def measure() -> Iterator[Row]:
    """All measurements, one after another."""
    yield from planner_speed.measure()
    yield from short_walks.measure()
    yield from simulation(prepare(load_scenario("line")))
    yield from command()


def simulation(setup: Setup) -> Iterator[Row]:
    """The simulate stage against a bare Python loop over the same commands."""
    scheduler = Scheduler(setup.limits, setup.at_rest)
    schedule_flows(setup, scheduler, plan_open_loop(setup).segments())
    ctrl = np.concatenate(list(setup.commands(scheduler.finish(), STEPS)))

    def staged() -> None:
        recorder = Recorder(
            Engine(setup.model),
            Sensors(setup.model, setup.robot),
            setup.scenario.sample_every,
        )
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
    yield Row(
        "speed of the simulate stage over a bare mj_step loop", ratio, "", ">= 0.9"
    )
    yield Row("physics steps in a second", len(ctrl) / took, "1/s")


def command() -> Iterator[Row]:
    """The command as a process: its response time, and the memory of a run."""
    start = [sys.executable, "-m", "sim.cli"]

    def answer() -> None:
        subprocess.run([*start, "--help"], check=True, stdout=subprocess.DEVNULL)

    def nothing() -> None:
        subprocess.run([sys.executable, "-c", "pass"], check=True)

    yield Row("stratawalk --help answers in", median(answer), "s", "< 0.3")
    yield Row("python alone starts in", median(nothing), "s")
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "run")
        run = [*start, "run", "ellipse", "--no-video", "--out", out]
        took = seconds(
            lambda: subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
        )
        yield Row("run ellipse --no-video takes", took, "s")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    yield Row("and at most this much memory", peak, "MB", "< 600")
