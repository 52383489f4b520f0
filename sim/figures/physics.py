"""Walks in the physics for the figures, computed in parallel."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from multiprocessing import active_children, get_context

import numpy as np

from planner import Array, Flow
from sim.evaluation.assessment import Evaluation, evaluate, summarise
from sim.evaluation.motions import commanded_angles
from sim.evaluation.summary import Summary
from sim.interruption import deaf
from sim.motion.poses import rotate
from sim.motion.schedule import Phase
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, silent
from sim.scenarios.file import load_scenario
from sim.simulation import simulate
from sim.walking.finished import Walk
from sim.walking.walker import Walker

SAMPLE_EVERY = 50  # steps; bodies move a millimetre in between
NOMINAL = 601  # points of the nominal path
PREDICTED = ("ideal", "quasi_static")
KEPT = ("achieved", *PREDICTED)


@dataclass(frozen=True)
class Job:
    """A walk to make."""

    scenario: str
    changes: Mapping[str, object] = field(default_factory=dict)
    flows: tuple[Flow, ...] = ()  # carried out instead of a plan for the scenario


@dataclass(frozen=True)
class Walked:
    """The data of a finished walk that the figures need, from the start of the walk.

    Attributes:
        summary: As in summary.json, timing left out.
        pose: Achieved and predicted poses by name, shape (T, 3) each.
        margin: Likewise, shape (T,) each [m].
        clearance: Likewise, where there are obstacles.
        swing: Commanded angle of each group, shape (T, G) [rad].
        qpos: Joint positions, shape (T, nq).
        time: Of each row since the walk starts, shape (T,) [s].
        segment: Of each row, shape (T,).
        moving: Which group swings under load, -1 if none does, shape (T,).
        feet: Where each foot touches and where it was planned to, (T, F, 2) [m].
        contact: Whether it does and whether it was planned to, (T, F), bool.
        nominal: Points of the nominal path, shape (M, 2) [m].
    """

    summary: Summary
    pose: Mapping[str, Array]
    margin: Mapping[str, Array]
    clearance: Mapping[str, Array]
    swing: Array
    qpos: Array
    time: Array
    segment: Array
    moving: Array
    feet: Mapping[str, Array]
    contact: Mapping[str, Array]
    nominal: Array

    @property
    def segments(self) -> int:
        """Number of segments walked."""
        return self.summary.segments


def perform(job: Job) -> Walked:
    """Make one walk."""
    settings = {"sample_every": SAMPLE_EVERY, **job.changes}
    scenario = load_scenario(job.scenario, settings)
    if job.flows:
        walk = _carried_out(prepare(scenario), job.flows)
        return _gathered(evaluate(walk, ("creep_floor",)))
    return _gathered(simulate(scenario).evaluation)


@contextmanager
def begun(
    jobs: Mapping[str, Job], progress: Progress = silent
) -> Iterator[Mapping[str, Future[Walked]]]:
    """Walks being computed in parallel, one on each core."""
    cores = min(len(os.sched_getaffinity(0)), len(jobs)) or 1
    done = count(1)

    def tell(_: Future[Walked]) -> None:
        progress("walking", next(done) / len(jobs))

    with ProcessPoolExecutor(cores, mp_context=get_context("spawn")) as pool:
        try:
            later_first = list(jobs)[::-1]  # later figures walk farther
            with deaf():
                walks = {name: pool.submit(perform, jobs[name]) for name in later_first}
            for walk in walks.values():
                walk.add_done_callback(tell)
            yield walks
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in active_children():
                process.kill()
            raise


def _carried_out(setup: Setup, flows: Sequence[Flow]) -> Walk:
    walker = Walker(setup)
    walker.stand()
    walker.go([flows])
    return walker.finish()


def _gathered(evaluation: Evaluation) -> Walked:
    made, achieved = evaluation.walk, evaluation.achieved
    setup, on = made.setup, evaluation.walking
    phases = made.phases
    starts = np.array([phase.start for phase in phases])
    at = np.searchsorted(starts, made.recording.during, side="right") - 1
    swing, lift = commanded_angles(made)
    predicted = {name: evaluation.predicted[name] for name in PREDICTED}
    stance = setup.kinematics.stance(swing, lift)
    ideal = predicted["ideal"]
    planned = ideal.pose[:, None, :2] + rotate(stance.feet, ideal.pose[:, 2:])
    poses = {name: prediction.pose for name, prediction in predicted.items()}
    margins = {name: prediction.margin for name, prediction in predicted.items()}
    during = made.recording.during[on]
    near = {n: c[on] for n, c in evaluation.clearance.items() if n in KEPT}
    return Walked(
        summary=summarise(evaluation),
        pose={n: p[on] for n, p in {**poses, "achieved": achieved.pose}.items()},
        margin={n: m[on] for n, m in {**margins, "achieved": achieved.margin}.items()},
        clearance=near,
        swing=swing[on],
        qpos=made.recording.moments.qpos[on],
        time=setup.limits.timestep * (during - during[0]),
        segment=np.array([phase.segment for phase in phases])[at][on],
        moving=np.array([_swept(setup, phase) for phase in phases])[at][on],
        feet={"planned": planned[on], "achieved": achieved.point[on]},
        contact={"planned": ideal.contact[on], "achieved": achieved.contact[on]},
        nominal=setup.scenario.path.curve.at(np.linspace(0, 1, NOMINAL))[:, :2],
    )


def _swept(setup: Setup, phase: Phase) -> int:
    """Index of the group that swings under load, -1 if none does."""
    loaded = [i for i in phase.moving if setup.robot.groups[i] in phase.stratum]
    return loaded[0] if phase.kind == "swing" and loaded else -1
