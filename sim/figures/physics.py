"""Walks in the physics for the figures, computed in parallel."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import active_children, get_context

import numpy as np

from planner import Array, Flow
from sim.evaluation.assessment import Evaluation, evaluate, summarise
from sim.evaluation.motions import Achieved, commanded_angles
from sim.evaluation.summary import Summary
from sim.interruption import deaf
from sim.motion.poses import rotate
from sim.motion.prediction import Prediction
from sim.motion.schedule import Phase
from sim.preparation.setup import Setup, prepare
from sim.scenarios.file import load_scenario
from sim.simulation import simulate
from sim.walking.walks import Walker

SAMPLE_EVERY = 50  # steps; bodies move a millimetre in between
NOMINAL = 601  # points of the nominal path
PREDICTED = ("ideal", "quasi_static")
WITHOUT = ("identified", "compliant", "creep_floor")  # at length, and in no figure


@dataclass(frozen=True)
class Job:
    """A walk to make."""

    scenario: str
    changes: Mapping[str, object] = field(default_factory=dict)
    flows: tuple[Flow, ...] = ()  # carried out instead of a plan for the scenario
    cost: float = 4.0  # about how long it takes [s], for estimates


@dataclass(frozen=True)
class Walked:
    """The data of a finished walk that the figures need, from the start of the walk."""

    summary: Summary  # timing left out
    pose: Mapping[str, Array]  # achieved and predicted, by name, (T, 3) each
    margin: Mapping[str, Array]  # likewise, (T,) each [m]
    clearance: Mapping[str, Array]  # likewise, where there are obstacles
    swing: Array  # commanded angle of each group, (T, G) [rad]
    qpos: Array  # joint positions, (T, nq)
    time: Array  # since the walk starts, (T,) [s]
    segment: Array  # of each row, (T,)
    moving: Array  # which group swings under load, -1 if none does, (T,)
    feet: Mapping[str, Array]  # achieved and planned, (T, F, 2) [m]
    contact: Mapping[str, Array]  # achieved and planned, (T, F), bool
    nominal: Array  # points of the nominal path, (M, 2) [m]

    @property
    def segments(self) -> int:
        """Number of segments walked."""
        return self.summary.segments

    @property
    def ends(self) -> Array:
        """Last row of each segment, shape (segments,)."""
        return np.append(np.flatnonzero(np.diff(self.segment)), len(self.segment) - 1)


def perform(job: Job) -> Walked:
    """Make one walk."""
    settings = {"sample_every": SAMPLE_EVERY, **job.changes}
    scenario = load_scenario(job.scenario, settings)
    if not job.flows:
        return _gathered(simulate(scenario, without=WITHOUT).evaluation)
    walker = Walker(prepare(scenario))
    walker.stand()
    walker.go([job.flows])
    return _gathered(evaluate(walker.finish(), WITHOUT))


@contextmanager
def begun(
    jobs: Mapping[str, Job], finished: Callable[[Job, Future[Walked]], None]
) -> Iterator[Mapping[str, Future[Walked]]]:
    """Walks being computed in parallel, one on each core."""
    cores = min(len(os.sched_getaffinity(0)), len(jobs)) or 1
    with ProcessPoolExecutor(cores, mp_context=get_context("spawn")) as pool:
        try:
            later_first = list(jobs)[::-1]  # later figures walk farther
            with deaf():
                walks = {name: pool.submit(perform, jobs[name]) for name in later_first}
            for name, walk in walks.items():
                walk.add_done_callback(partial(finished, jobs[name]))
            yield walks
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in active_children():
                process.kill()
            raise


def _gathered(evaluation: Evaluation) -> Walked:
    made, achieved = evaluation.walk, evaluation.achieved
    setup, on, phases = made.setup, evaluation.walking, made.phases
    starts = np.array([phase.start for phase in phases])
    at = np.searchsorted(starts, made.recording.during, side="right") - 1
    swing, lift = commanded_angles(made)
    predicted = {name: evaluation.predicted[name] for name in PREDICTED}
    motions: dict[str, Achieved | Prediction] = {"achieved": achieved, **predicted}
    ideal = predicted["ideal"]
    stance = setup.kinematics.stance(swing, lift)
    planned = ideal.pose[:, None, :2] + rotate(stance.feet, ideal.pose[:, 2:])
    during, near = made.recording.during[on], evaluation.clearance
    return Walked(
        summary=summarise(evaluation),
        pose={name: motion.pose[on] for name, motion in motions.items()},
        margin={name: motion.margin[on] for name, motion in motions.items()},
        clearance={name: near[name][on] for name in motions if name in near},
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
    loaded = (i for i in phase.moving if setup.robot.groups[i] in phase.stratum)
    return next(loaded, -1) if phase.kind == "swing" else -1
