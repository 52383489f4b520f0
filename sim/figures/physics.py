"""Walks in the physics for the figures, computed in parallel."""

import os
from collections.abc import Callable, Iterator, Mapping, MutableSequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from threading import Thread

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
from sim.scenarios.predictions import COSTLY
from sim.simulation import simulate
from sim.walking.walks import Walker

NOMINAL = 601  # points of the nominal path
PREDICTED = ("ideal", "quasi_static")


@dataclass(frozen=True)
class Job:
    """A walk to make."""

    scenario: str
    changes: Mapping[str, object] = field(default_factory=dict)
    flows: tuple[Flow, ...] = ()  # carried out instead of a plan for the scenario
    cost: float = 0.4  # about how much CPU it takes [s], for estimates


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
    def ends(self) -> Array:
        """Last row of each segment, shape (segments,)."""
        return np.append(np.flatnonzero(np.diff(self.segment)), len(self.segment) - 1)


Walks = Mapping[str, Future[Walked]]
_walked: MutableSequence[float]  # in a process of the pool


def perform(job: Job, report: Callable[[float], object] = lambda part: None) -> Walked:
    """Make one walk; how much of it is walked is reported from time to time."""
    settings = {"sample_every": 50, **job.changes}  # bodies move a millimetre
    scenario = load_scenario(job.scenario, settings)
    if not job.flows:

        def progress(stage: str, part: float) -> None:
            if stage == "walking":
                report(part)

        done = simulate(scenario, without=COSTLY, progress=progress)
        return _gathered(done.evaluation)
    walker = Walker(prepare(scenario))
    walker.stand()
    walker.go([job.flows])
    return _gathered(evaluate(walker.finish(), COSTLY))


@contextmanager
def begun(jobs: Mapping[str, Job]) -> Iterator[tuple[Walks, Callable[[], float]]]:
    """Walks being computed in parallel, one on each core, and how much is done [s]."""
    cores = min(len(os.sched_getaffinity(0)), len(jobs)) or 1
    context = get_context("spawn")
    walked = context.Array("d", len(jobs) or 1, lock=False)  # share of each, in order
    costs = np.array([job.cost for job in jobs.values()])
    with ProcessPoolExecutor(cores, context, _share, (walked,)) as pool:
        try:
            later_first = [*enumerate(jobs)][::-1]  # later figures walk farther
            with deaf():
                walks = {n: pool.submit(_perform, jobs[n], i) for i, n in later_first}
            yield walks, lambda: float(costs @ walked[: len(costs)])
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in active_children():
                process.kill()
            raise


def time_left(walking: float, drawing: float) -> float:
    """Time until walks and sheets of so much CPU are done [s].

    A process on each core walks, and one more draws; the cores share their time among
    them. In the end it draws alone, and what is left takes longer for its CPU.
    """
    cores = len(os.sched_getaffinity(0))
    share = cores / (cores + 1)
    together = walking / (cores * share)
    return together + max(0.0, drawing - share * together)


def _share(walked: MutableSequence[float]) -> None:
    """Where a process tells of its walks; it ends with the one that began it."""
    global _walked
    _walked = walked
    Thread(target=_end_as_well, args=(parent_process(),), daemon=True).start()


def _end_as_well(parent: BaseProcess) -> None:
    parent.join()  # it may be killed, or end during a long step
    os._exit(1)


def _perform(job: Job, number: int) -> Walked:
    made = perform(job, partial(_walked.__setitem__, number))
    _walked[number] = 1.0
    return made


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
