"""Achieved and predicted motion of a walk on one time axis, and their summary.

docs/numbers.md defines every number. Files are written by `sim.run_folder`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from models import MeasurementError
from planner import Array
from sim.evaluation.achieved import Achieved, achieved_motion
from sim.evaluation.attribution import error_sources
from sim.evaluation.comparison import describe
from sim.evaluation.deviations import (
    departure,
    deviation_from,
    deviations,
    off,
    per_metre,
)
from sim.evaluation.following import clearances, commands_along, predicted_along
from sim.evaluation.phases import (
    count_changes,
    moving_time,
    swing_slip,
    swing_travel,
)
from sim.evaluation.summary import Accomplished, Departure, Predicted, Summary
from sim.evaluation.verdict import Verdict, judge
from sim.experiments.creep import creep_floor
from sim.experiments.predictions import MODELS, follows_commands, twist_model
from sim.motion.prediction import Prediction
from sim.planning.sharing import Cache, no_cache, walk_cache, world_cache
from sim.preparation.shared import Shared
from sim.progress import Progress, silent, stage
from sim.scenarios.predictions import QUASI_STATIC
from sim.versions import versions
from sim.walking.finished import Walk


@dataclass(frozen=True)
class Evaluation:
    """A walk with its predictions, at every recorded moment.

    Example:
        >>> from sim import load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> found = simulate(load_scenario("line", short)).evaluation
        >>> bool(abs(found.achieved.pose[-1] - [0.01, 0.01, 0.0]).max() < 1e-4)
        True
    """

    walk: Walk
    achieved: Achieved
    predicted: Mapping[str, Prediction]
    unpredicted: Mapping[str, str]  # predictions that could not be made, and why
    clearance: Mapping[str, Array]  # achieved and predicted, if there are obstacles
    walking: Array  # moments from the start of the walk on, (T,), bool
    deviation: Mapping[str, Departure | None]  # from the nominal path
    creep_floor: float | None  # slip while standing as long, if measured [m]

    @cached_property
    def summary(self) -> Summary:
        """The numbers of summary.json."""
        return summarise(self, self.walk.seconds)

    def __str__(self) -> str:
        return describe(self.summary)

    @cached_property
    def verdict(self) -> Verdict:
        """What became of the walk."""
        predicted = self.predicted.get(QUASI_STATIC.key)
        return judge(self.walk, self.achieved, predicted, self.judged)

    @property
    def judged(self) -> Array:
        """Moments over which the summary takes extremes, (T,), bool."""
        return judged(self.walk)


def evaluate(
    walk: Walk,
    without: Collection[str] = (),
    shared: Shared | None = None,
    progress: Progress = silent,
) -> Evaluation:
    """Compare the achieved motion with every prediction.

    Args:
        walk: A finished walk.
        without: What to leave out of that on which nothing else depends: predictions,
            and `creep_floor`, which the robot stands for as long as it walked.
        shared: What earlier evaluations have made.
        progress: Called with the stage and the finished part of it.

    Example:
        >>> from sim import evaluate, load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> walk = simulate(load_scenario("line", short)).evaluation.walk
        >>> sorted(evaluate(walk).predicted)
        ['ideal', 'identified', 'quasi_static']
    """
    predicted: dict[str, Prediction] = {}
    unpredicted: dict[str, str] = {}
    cache = walk_cache(walk.setup, shared)
    caches: dict[str, Cache] = {"achieved": no_cache}
    measured = world_cache(walk.setup, shared)
    given = cache(
        "commanded", lambda: [list(commands_along(walk, s)) for s in walk.stretches]
    )
    strata = {phase.stratum for phase in walk.phases if phase.kind == "swing"}
    for name in MODELS:
        if name in without:
            unpredicted[name] = "left out"
            continue
        try:
            alike = follows_commands(walk.setup, name, strata)
            caches[name] = cache if alike else no_cache
            twists = partial(measured, name, partial(twist_model, walk.setup, name))
            follow = partial(predicted_along, walk, twists, given)
            with stage(progress, f"following {name.replace('_', '-')}"):
                predicted[name] = caches[name](name, follow)
        except MeasurementError as error:
            unpredicted[name] = str(error)
    achieved = achieved_motion(walk)
    poses = {name: found.pose for name, found in predicted.items()}
    deviation = _deviation(walk, caches, {**poses, "achieved": achieved.pose})
    creep = None
    if "creep_floor" not in without:
        stand = partial(creep_floor, walk.setup, walk.duration)
        with stage(progress, "measuring the solver's creep"):
            creep = measured(f"creep in {walk.duration} s", stand)
    return Evaluation(
        walk,
        achieved,
        predicted,
        unpredicted,
        clearances(walk, predicted),
        walk.recording.moments.step >= walk.starts,
        deviation,
        creep,
    )


def _deviation(
    walk: Walk, caches: Mapping[str, Cache], poses: Mapping[str, Array]
) -> Mapping[str, Departure | None]:
    """How far the walk and its predictions are from the nominal path at most."""
    curve, count = walk.setup.scenario.path.curve, judged(walk)
    found = {
        name: partial(
            caches[name], f"deviation {name}", partial(deviation_from, curve, some)
        )
        for name, some in ((name, pose[count]) for name, pose in poses.items())
    }
    return deviations(walk.setup.scenario, found)


def judged(walk: Walk) -> Array:
    """Moments over which extremes of a walk are taken, shape (T,), bool.

    They depend on the commands alone, not on which rows are written.
    """
    recording = walk.recording
    found: Array = recording.moments.step >= walk.starts
    return found & recording.marks.inspected


def summarise(
    evaluation: Evaluation,
    timing: Mapping[str, float] | None = None,
    fallback: str | None = None,
    missed: Sequence[float] = (),
) -> Summary:
    """The numbers of summary.json, unrounded.

    A fallback says why the stratified plan stands where a shorter one was asked for;
    `missed` is how far from the goal each of several walks ended [m].
    """
    walk, achieved = evaluation.walk, evaluation.achieved
    setup, scenario = walk.setup, walk.setup.scenario
    recording, dt = walk.recording, setup.limits.timestep
    pose, goal = achieved.pose[-1], np.array(scenario.path.goal, dtype=float)
    swings = [p for p in walk.phases if p.kind == "swing"]
    length, walked = scenario.path.length, walk.distance
    strokes = swing_travel(swings, setup.robot.groups, loaded=True)
    slip, in_swings, judged = achieved.slip[-1], swing_slip(walk), evaluation.judged
    absent = dict.fromkeys(evaluation.unpredicted)
    errors: dict[str, Departure | None] = {
        name: off(achieved.pose[judged], prediction.pose[judged], length, walked)
        for name, prediction in evaluation.predicted.items()
    }
    predicted: dict[str, Predicted | None] = {
        name: Predicted(
            pose=prediction.pose[-1].tolist(),
            min_margin=float(prediction.margin[judged].min()),
            slip=float(prediction.slip[-1].sum()),
            min_clearance=_least(evaluation, name),
        )
        for name, prediction in evaluation.predicted.items()
    }
    return Summary(
        verdict=evaluation.verdict.word,
        verdict_text=evaluation.verdict.text,
        scenario=scenario.name,
        robot=setup.robot.name,
        fields=scenario.fields,
        stance=setup.stance,
        segments=scenario.segments,
        replan=scenario.replan,
        steer=scenario.steer,
        optimise=scenario.optimise,
        together=scenario.overlap_recovery,
        correct=scenario.correct,
        goal=goal.tolist(),
        path_length=length,
        distance_walked=walked,
        contact_switches=sum(p.kind in ("lift", "land") for p in walk.phases),
        contact_switches_achieved=count_changes(walk),
        swing_travel=strokes,
        air_travel=swing_travel(swings, setup.robot.groups, loaded=False),
        bounces=recording.bounces,
        wall_contacts=recording.wall_contacts,
        self_contacts=recording.self_contacts,
        saturated_segments=walk.saturated_segments,
        let_down=setup.world.let_down,
        fastest_swing=max(
            (setup.limits.swing_peak(p.direction, p.amount) for p in swings),
            default=0.0,
        ),
        swing_speed=scenario.swing_speed,
        walk_starts=walk.starts * dt,
        predicted=predicted | absent,
        unpredicted=dict(evaluation.unpredicted),
        achieved=Accomplished(
            pose=pose.tolist(),
            min_margin=recording.least_margin,
            min_clearance=_least(evaluation, "achieved"),
            slip=float(slip.sum()),
            slip_swing=in_swings,
            slip_transition=float(slip.sum()) - in_swings,
            slip_per_foot={
                str(leg): float(s)
                for leg, s in zip(setup.robot.legs, slip, strict=True)
            },
            creep_floor=evaluation.creep_floor,
        ),
        error={**errors, **absent, "goal": departure(pose, goal)},
        error_sources=_sources(evaluation),
        servo=setup.servo.table(setup.world.servo),
        deviation=dict(evaluation.deviation),
        per_metre=per_metre(length, moving_time(walk), strokes),
        simulated_time=recording.steps * dt,
        timestep=dt,
        versions=versions(),
        fallback=fallback,
        missed=list(missed),
        timing=dict(timing or {}),
    )


def _least(evaluation: Evaluation, name: str) -> float | None:
    """Least clearance [m]; None where there are no obstacles."""
    clearance = evaluation.clearance.get(name)
    return None if clearance is None else float(clearance[evaluation.judged].min())


def _sources(
    evaluation: Evaluation,
) -> dict[str, dict[str, list[float]] | None] | None:
    """Sources of open-loop errors; None if each segment was planned from a new pose."""
    walk, achieved = evaluation.walk, evaluation.achieved.pose
    if walk.setup.scenario.replan:
        return None
    found: dict[str, dict[str, list[float]] | None] = {
        name: error_sources(walk, achieved, prediction)
        for name, prediction in evaluation.predicted.items()
    }
    return found | dict.fromkeys(evaluation.unpredicted)
