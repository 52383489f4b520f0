"""The main job: plan, walk, compare, write the run folder, film."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from sim.evaluation.evaluation import Summary, evaluate, summarise, trajectory
from sim.evaluation.phases import table
from sim.experiments.creep import creep_floor
from sim.folder import Pieces, RunFolder
from sim.physics.engine import STRETCH
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_open_loop
from sim.planning.routes import routed
from sim.preparation.effort import check_effort
from sim.preparation.resolve import resolved
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, silent
from sim.scenarios.file import dumps
from sim.scenarios.scenario import Scenario
from sim.walking.walker import Walker, carry_out, expected_steps
from sim.world.origin import origin

CARD = "model.toml"  # beside model.xml, as a robot's card is
DENSE = 10  # times that commands shrink when they are written; 7.6 measured


def run(
    scenario: Scenario,
    folder: RunFolder,
    *,
    look: str | None = None,
    progress: Progress = silent,
) -> Summary:
    """Carry a scenario out and leave everything about it in a folder.

    Args:
        scenario: What to walk.
        folder: Empty folder of this run.
        look: Look of the film, `draft` or `final`; None makes no film and needs no GL.
        progress: Told the stage and how much of it is done.

    Returns:
        The summary, as written to summary.json.

    Raises:
        PlannerError: If there is no plan.
        UsageError: If the walk takes more steps or memory than there can be.
        SimulationError: If the physics diverges.
        FilesError: If the folder cannot be written.
        RenderError: If a film is wanted and cannot be made.
    """
    timing: dict[str, float] = {}
    with _timed(timing, "compile"):
        setup = prepare(scenario)
    with _timed(timing, "plan"):
        setup = routed(setup)
        scenario = setup.scenario
        setup = within_bounds(setup)
        planned = None if scenario.replan else plan_open_loop(setup)
        steps = expected_steps(setup, planned)
        check_effort(setup, steps)
    folder.reserve(steps * 8 * (1 + setup.model.nu) // DENSE)
    _write_setup(folder, setup, scenario)
    walker = Walker(setup, progress)
    try:
        walked = carry_out(walker, planned)
    finally:
        _write_commands(folder, walker)  # what a failed walk is replayed from
    timing["plan"] += walked.seconds["plan"]
    timing["simulate"] = walked.seconds["simulate"]
    with _timed(timing, "evaluate"):
        evaluation = evaluate(walked)
        seconds = evaluation.walk.duration
        summary = summarise(evaluation, creep_floor(setup, seconds))
        folder.write_arrays("trajectory.npz", trajectory(evaluation))
        folder.write_text("flows.csv", table(walked))
    timing["render"] = 0.0
    summary["timing"] = timing
    folder.write_json("summary.json", summary)
    if look is not None:
        from sim.pictures.direction import film

        with _timed(timing, "render"):
            film(folder.path, look=look, progress=lambda f: progress("filming", f))
        folder.write_json("summary.json", summary)
    return summary


def _write_setup(folder: RunFolder, setup: Setup, scenario: Scenario) -> None:
    """All that a run is made of, so that the folder can be run again anywhere."""
    robot, copies = origin(setup.robot)
    files = setup.world.files | {CARD: setup.robot.card_text.encode()} | copies
    for name, content in files.items():
        folder.write_bytes(name, content)
    folder.write_text("scenario.toml", dumps(resolved(setup, scenario, robot)))


def _write_commands(folder: RunFolder, walker: Walker) -> None:
    steps, timestep = walker.steps, walker.setup.limits.timestep
    if not steps:
        return
    rows = np.split(np.arange(steps), range(STRETCH, steps, STRETCH))
    clock = Pieces((steps,), (row * timestep for row in rows))
    ctrl = Pieces((steps, walker.setup.model.nu), walker.commands())
    folder.write_arrays("commands.npz", [("time", clock), ("ctrl", ctrl)])


@contextmanager
def _timed(timing: dict[str, float], stage: str) -> Iterator[None]:
    began = time.perf_counter()
    yield
    timing[stage] = time.perf_counter() - began
