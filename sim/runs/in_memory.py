"""The run that has just been simulated, from memory."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from models.description import parse_toml
from planner import Array
from sim.evaluation.assessment import Evaluation
from sim.evaluation.phases import carried_out
from sim.evaluation.summary import Summary
from sim.runs.arrays import Arrays
from sim.runs.run import START, Run
from sim.scenarios.file import dumps
from sim.scenarios.predictions import PREDICTIONS
from sim.walking.finished import Walk


def run_of(
    evaluation: Evaluation,
    summary: Summary,
    settings: str | None = None,
    folder: Path | None = None,
) -> Run:
    """The run of a walk and its evaluation; `settings` is the text of scenario.toml."""
    setup = evaluation.walk.setup
    return Run(
        folder=Path() if folder is None else folder.resolve(),
        settings=parse_toml(dumps(setup.scenario) if settings is None else settings),
        card_text=setup.robot.card_text,
        summary=summary,
        phases=carried_out(evaluation.walk),
        arrays=trajectory(evaluation),
        commands=Arrays(("time", "ctrl"), partial(_commands, evaluation.walk)),
        stops=followed.stops if (followed := evaluation.walk.followed) else (),
    )


def trajectory(evaluation: Evaluation) -> Arrays:
    """The arrays of trajectory.npz: achieved motion and predictions, row by row."""
    walk, achieved = evaluation.walk, evaluation.achieved
    recording, predicted = walk.recording, evaluation.predicted
    moments, planned = recording.moments, next(iter(predicted.values()))
    starts = np.array([phase.start for phase in walk.phases])
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
        arrays["measured_pose"] = real.pose
    for key, clearance in evaluation.clearance.items():
        known = PREDICTIONS.get(key)
        arrays[known.array("clearance") if known else f"{key}_clearance"] = clearance
    sampled = recording.marks.sampled

    def load(name: str) -> Array:
        return walk.origin if name == START else arrays[name][sampled]

    return Arrays((*arrays, START), load)


def _commands(walk: Walk, name: str) -> Array:
    """One of the arrays of commands.npz, computed from the schedules."""
    if name == "time":
        return np.arange(walk.steps) * walk.setup.limits.timestep
    return np.concatenate(list(walk.commands()))
