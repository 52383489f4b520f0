"""The run folder: everything about a simulation, written as soon as it exists."""

import shutil
import time
import warnings
from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from models import Robot
from models.description import parse_toml
from planner import Array
from sim.endings import command
from sim.errors import SimulationError, UsageError, one_line
from sim.evaluation import flows
from sim.evaluation.assessment import Evaluation, evaluate
from sim.evaluation.phases import carried_out
from sim.evaluation.summary import Summary
from sim.feedback.stops import written as feedback_table
from sim.folder import Pieces, RunFolder, claim, new_file
from sim.logs.log import Log, written
from sim.physics.engine import STRETCH
from sim.preparation.setup import Setup
from sim.progress import Progress, silent, stage
from sim.runs.arrays import Arrays
from sim.runs.run import START, Run
from sim.runs.seals import CARD, seals
from sim.scenarios.file import dumps
from sim.scenarios.predictions import PREDICTIONS
from sim.scenarios.scenario import Scenario
from sim.simulation import Prepared, Simulation, simulate
from sim.walking.finished import Walk
from sim.walking.walks import Walker
from sim.world.model import origin

MOTION, LEARNT = "motion.csv", "learnt.toml"  # what was played, and learnt
DENSE = 10  # compression of the commands; 7.6 was measured


class Writer:
    """Writes the results of a simulation into a folder."""

    def __init__(self, folder: RunFolder) -> None:
        self.folder = folder
        self.settings, self.copies = "", set[str]()  # names of files beside the results

    def prepared(self, prepared: Prepared) -> None:
        """Everything that the run depends on; the folder can be run again anywhere."""
        self.folder.reserve(prepared.steps * 8 * (1 + prepared.setup.model.nu) // DENSE)
        self.setup(prepared.setup, prepared.scenario)

    def setup(self, setup: Setup, scenario: Scenario) -> None:
        """Model, card, the robot as it was given, and the scenario, undivided."""
        robot, copies = origin(setup.robot)
        files = {CARD: setup.robot.card_text.encode(), **setup.world.files, **copies}
        if setup.motion is not None:
            files[MOTION] = written(setup.motion.log).encode()
            scenario = replace(scenario, motion=MOTION)
        for name, content in files.items():
            self.folder.write_bytes(name, content)
        self.copies = files.keys() - {CARD} | {LEARNT}
        self.settings = dumps(setup.resolved(scenario, robot))
        self.folder.write_text("scenario.toml", self.settings)

    def walked(self, walk: Walker | Walk) -> None:
        """The commands, with which even a walk that failed can be replayed."""
        steps, timestep = walk.steps, walk.setup.limits.timestep
        if not steps:
            return
        rows = np.split(np.arange(steps), range(STRETCH, steps, STRETCH))
        clock = Pieces((steps,), (row * timestep for row in rows))
        ctrl = Pieces((steps, walk.setup.model.nu), walk.commands())
        self.folder.write_arrays("commands.npz", [("time", clock), ("ctrl", ctrl)])
        if isinstance(walk, Walker) and (last := walk.last_states) is not None:
            ends = (np.arange(steps - len(last.qpos), steps) + 1) * timestep
            states = [("time", ends), ("qpos", last.qpos), ("qvel", last.qvel)]
            self.folder.write_arrays("divergence.npz", states)

    def finished(self, evaluation: Evaluation, summary: Summary) -> Run:
        """States, predictions and numbers; the run, which is not read back."""
        run = run_of(evaluation, summary, self.settings, self.folder.path)
        self.folder.write_arrays("trajectory.npz", run.arrays.items())
        self.folder.write_text("flows.csv", flows.written(run.phases))
        if followed := evaluation.walk.followed:
            self.folder.write_text("feedback.csv", feedback_table(followed.stops))
            if learnt := followed.learnt:
                self.folder.write_text(LEARNT, str(learnt))
        tables = run.settings, parse_toml(run.card_text), run.summary.to_json()
        own = seals(run.folder, *tables, copies=self.copies)
        run = replace(run, summary=replace(run.summary, seals=own))
        self.folder.write_json("summary.json", run.summary.to_json())
        return run


def _report(
    run: Run, warn: Callable[[str], object] = warnings.warn, progress: Progress = silent
) -> None:
    """The page that explains a run; what fails here is a warning alone."""
    try:
        from sim.reports.page import write_report

        write_report(run, progress)
    except Exception as error:  # a drawing library may raise anything
        warn(f"no report: {one_line(error)}")


def run(
    scenario: Scenario,
    folder: RunFolder,
    *,
    robot: Robot | None = None,
    look: str | None = None,
    progress: Progress = silent,
    warn: Callable[[str], object] = warnings.warn,
    without: Collection[str] = (),
    log: Log | None = None,
) -> Summary:
    """Carry out a scenario and write everything about it into an empty folder.

    A film has a look; without one no GL is needed. Comparisons can be left out as in
    `simulate`. A line warns of what could not be written though the run is complete.
    """
    writer, own = Writer(folder), not any(folder.path.iterdir())
    try:
        walk = partial(simulate, scenario, robot=robot, without=without, log=log)
        simulation = walk(progress=progress, witness=writer)
    except UsageError:  # which comes before anything is walked
        if own:
            shutil.rmtree(folder.path, ignore_errors=True)
        raise
    except SimulationError as error:
        again = folder.path / "scenario.toml"
        if not again.exists():
            raise
        words = ["--set", error.setting] if error.setting else []
        line = command("run", again, "--no-video", *words)
        remedy = f"{error.remedy}; walk again: {line}"
        raise SimulationError(error.what, error.where, remedy) from error
    summary = replace(simulation.summary, timing=simulation.timing | {"render": 0.0})
    with stage(progress, "writing"):
        finished = writer.finished(simulation.evaluation, summary)
    summary = finished.summary
    _report(finished, warn, progress)
    if look is not None:
        from sim.pictures.run_film import film_folder

        began = time.perf_counter()
        film_folder(folder.path, look=look, progress=lambda f: progress("filming", f))
        render = {"render": time.perf_counter() - began}
        summary = replace(summary, timing=simulation.timing | render)
        folder.write_json("summary.json", summary.to_json())
    return summary


def write(done: Simulation | Evaluation, folder: str | Path | None = None) -> Path:
    """Write a run folder.

    Args:
        done: What was simulated, or a walk that was evaluated.
        folder: Folder to make; None takes the next free number in `runs`.

    Returns:
        The folder's path.

    Raises:
        UsageError: If the folder exists.
        FilesError: If it cannot be made or written.

    Example:
        >>> from sim import load_scenario, simulate, write
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> folder = write(simulate(load_scenario("line", short)), "mine")
        >>> (folder / "report.html").is_file()
        True
    """
    writer, run = _written(done, folder)
    _report(run)
    return writer.folder.path


def film(
    walked: Walk | Evaluation | Simulation,
    path: str | Path,
    *,
    look: str = "draft",
    progress: Progress = silent,
) -> Path:
    """Film a walk that has no run folder.

    Args:
        walked: What to film.
        path: The film's file, which must not exist and ends in `.mp4`.
        look: `draft`, or `final` with shadows and smooth edges, several times slower.
        progress: Called with each stage and the finished part of it.

    Returns:
        The film's path.

    Raises:
        UsageError: If the file exists, is no `.mp4`, or there is no such look.
        RenderError: If pictures cannot be drawn or encoded.
        FilesError: If the film cannot be written.

    Example:
        >>> from sim import film, load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0], "playback": 60}
        >>> done = simulate(load_scenario("line", short))
        >>> film(done, "mine.mp4").name  # doctest: +SKIP
        'mine.mp4'
    """
    from sim.pictures.run_film import film_folder

    path = new_file(Path(path), "film", ".mp4")
    done = evaluate(walked) if isinstance(walked, Walk) else walked
    with TemporaryDirectory() as scratch:
        _, run = _written(done, Path(scratch) / "run")
        shown = partial(progress, "filming")
        return film_folder(run.folder, look=look, path=path, progress=shown)


def _written(
    done: Simulation | Evaluation, folder: str | Path | None
) -> tuple[Writer, Run]:
    """Write a run folder without its report, which takes as long as all the rest."""
    evaluation = done.evaluation if isinstance(done, Simulation) else done
    setup = evaluation.walk.setup
    asked = done.prepared.scenario if isinstance(done, Simulation) else setup.scenario
    writer = Writer(claim(None if folder is None else Path(folder), asked.name))
    writer.setup(setup, asked)
    writer.walked(evaluation.walk)
    return writer, writer.finished(evaluation, done.summary)


def run_of(
    evaluation: Evaluation,
    summary: Summary,
    settings: str | None = None,
    folder: Path | None = None,
) -> Run:
    """The run of a walk and its evaluation; `settings` is the text of scenario.toml."""
    walk, setup = evaluation.walk, evaluation.walk.setup

    def commands(name: str) -> Array:
        clock = np.arange(walk.steps) * setup.limits.timestep
        return clock if name == "time" else np.concatenate(list(walk.commands()))

    return Run(
        folder=Path() if folder is None else folder.resolve(),
        settings=parse_toml(dumps(setup.scenario) if settings is None else settings),
        card_text=setup.robot.card_text,
        summary=summary,
        phases=carried_out(walk),
        arrays=trajectory(evaluation),
        commands=Arrays(("time", "ctrl"), commands),
        stops=followed.stops if (followed := walk.followed) else (),
    )


def trajectory(evaluation: Evaluation) -> Arrays:
    """The arrays of trajectory.npz: achieved motion and predictions, row by row."""
    walk, achieved = evaluation.walk, evaluation.achieved
    recording, predicted = walk.recording, evaluation.predicted
    moments, planned = recording.moments, next(iter(predicted.values()))
    starts = [phase.start for phase in walk.phases]
    arrays = {
        "time": moments.step * recording.timestep,
        "qpos": moments.qpos,
        "qvel": moments.qvel,
        "achieved_pose": achieved.pose,
        "contact": achieved.contact,
        "planned_contact": planned.contact,
        "slip": achieved.slip,
        "achieved_margin": achieved.margin,
        "contact_point": achieved.point,
        "center_of_mass": achieved.center_of_mass,
        "phase": np.searchsorted(starts, recording.during, side="right") - 1,
    }
    for key, prediction in predicted.items():
        parts = {name: getattr(prediction, name) for name in ("pose", "slip", "margin")}
        for quantity, array in (parts | prediction.further).items():
            arrays[PREDICTIONS[key].array(quantity)] = array
    if (real := evaluation.measured) is not None:
        arrays |= {f"measured_{name}": rows for name, rows in real.arrays.items()}
    for key, clearance in evaluation.clearance.items():
        known = PREDICTIONS.get(key)
        arrays[known.array("clearance") if known else f"{key}_clearance"] = clearance
    return Arrays(
        (*arrays, START),
        lambda n: walk.origin if n == START else arrays[n][recording.marks.sampled],
    )
