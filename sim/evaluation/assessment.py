"""Achieved and predicted motion of a walk on one time axis, and their summary.

docs/numbers.md defines every number. Files are written by `sim.run_folder`.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from models import MeasurementError
from planner import Array
from sim.drive.drive import Drive
from sim.evaluation import deviations, motions, phases
from sim.evaluation.causes import Evidence
from sim.evaluation.quantities import describe
from sim.evaluation.summary import Accomplished, Departure, Predicted, Summary, Weighed
from sim.evaluation.verdict import Verdict, judge
from sim.experiments.identification import creep_floor, follows_commands, twist_model
from sim.logs.alignment import Measured, measured
from sim.motion.prediction import Prediction
from sim.preparation.shared import Cache, Shared, no_cache, world_cache
from sim.progress import Progress, silent, stage
from sim.scenarios.declaration import refusal
from sim.scenarios.predictions import OF_MOTIONS, PREDICTIONS, best
from sim.versions import versions
from sim.walking.finished import Walk

TOLD = ("fields", "segments", "replan", "steer", "optimise", "correct", "swing_speed")
"""Settings that the summary has under their own names."""


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
    achieved: motions.Achieved
    predicted: Mapping[str, Prediction]
    unpredicted: Mapping[str, str]  # predictions that could not be made, and why
    clearance: Mapping[str, Array]  # achieved and predicted, if there are obstacles
    walking: Array  # moments from the start of the walk on, (T,), bool
    judged: Array  # those of them over which extremes are taken, (T,), bool
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
        found = Evidence(self.walk, self.achieved, self.predicted, self.weighed)
        return judge(found, self.judged)

    @cached_property
    def measured(self) -> Measured | None:
        """What a log says of a real robot, at every recorded moment, if anything."""
        if (motion := self.walk.setup.motion) is None:
            return None
        time, (first, *_) = motions.time_of(self.walk), self.predicted.values()
        return measured(motion.log, time, first.pose)

    @cached_property
    def weighed(self) -> Weighed:
        """What the verdict weighs."""
        achieved, scale = self.achieved.pose[self.judged], self.scale
        predicted = self.predicted[scale.prediction].pose[self.judged]
        return scale.weigh(achieved, predicted, self.walk.setup.scenario.goal)

    @cached_property
    def scale(self) -> deviations.Scale:
        """What distances are weighed by: the path, or the way that is predicted."""
        setup, made = self.walk.setup, self.predicted
        reach = setup.kinematics.reach
        if setup.motion is None:
            return deviations.Scale.of(setup.scenario.path, reach, made)
        way = self.way or deviations.LEAST_WAY * reach
        return deviations.Scale(best(made), reach, way)

    @property
    def way(self) -> float:
        """Length of the way that is predicted of a motion that is played [m]."""
        rigid, setup = self.predicted[OF_MOTIONS[0]], self.walk.setup
        return deviations.predicted_way(rigid.pose[self.judged], setup.kinematics.reach)

    def least_clearance(self, name: str) -> float | None:
        """Of the walk or of a prediction [m]; None where there are no obstacles."""
        clearance = self.clearance.get(name)
        return None if clearance is None else float(clearance[self.judged].min())


def evaluate(
    walk: Walk,
    without: Collection[str] = (),
    shared: Shared | None = None,
    progress: Progress = silent,
) -> Evaluation:
    """Compare the achieved motion with every prediction.

    Args:
        walk: A finished walk.
        without: What to leave out: predictions that nothing else needs, and
            `creep_floor`, for which the robot stands for as long as it walked.
        shared: What earlier evaluations have built.
        progress: Called with the stage and the finished part of it.

    Example:
        >>> from sim import evaluate, load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> walk = simulate(load_scenario("line", short)).evaluation.walk
        >>> sorted(evaluate(walk).predicted)
        ['compliant', 'ideal', 'identified', 'quasi_static']
    """
    words = (*PREDICTIONS, "creep_floor")
    for word in without:
        if word not in words:
            raise refusal(word, f"some of {', '.join(words)}", "without")
    predicted: dict[str, Prediction] = {}
    unpredicted: dict[str, str] = {}
    caches: dict[str, Cache] = {}
    setup, motion = walk.setup, walk.setup.motion
    cache = setup.walk_cache(shared)
    of_world = world_cache(setup.scenario, setup.robot, shared)
    along = partial(motions.commands_along, walk)
    given = cache("commanded", lambda: [[*along(part)] for part in walk.stretches])
    strata = {phase.stratum for phase in walk.phases if phase.kind == "swing"}
    asked: Collection[str] = setup.scenario.predictions or PREDICTIONS
    for name in (names := tuple(PREDICTIONS) if motion is None else OF_MOTIONS):
        if name != names[0] and (name in without or name not in asked):
            unpredicted[name] = "left out"
            continue
        try:
            alike = motion is None and follows_commands(walk.setup, name, strata)
            caches[name] = cache if alike else no_cache
            twists = partial(of_world, name, partial(twist_model, setup, name))
            deviations.require_holding(walk, name, twists, strata)
            follow = partial(motions.predicted_along, walk, name, twists, given)
            with stage(progress, f"making the {name.replace('_', '-')} prediction"):
                predicted[name] = caches[name](name, follow)
        except MeasurementError as error:
            unpredicted[name] = str(error)
    achieved = motions.achieved_motion(walk)
    walking = walk.recording.moments.step >= walk.starts
    judged = walking & walk.recording.marks.inspected  # whichever rows are written
    poses = {name: found.pose[judged] for name, found in predicted.items()}
    poses["achieved"] = achieved.pose[judged]
    creep, stand = None, partial(creep_floor, setup, walk.duration)
    if "creep_floor" not in without:
        with stage(progress, "measuring the solver's creep"):
            creep = of_world(f"creep in {walk.duration} s", stand)
    return Evaluation(
        walk=walk,
        achieved=achieved,
        predicted=predicted,
        unpredicted=unpredicted,
        clearance=motions.clearances(walk, predicted),
        walking=walking,
        judged=judged,
        deviation=deviations.deviations(walk, caches, poses),
        creep_floor=creep,
    )


def summarise(
    evaluation: Evaluation,
    timing: Mapping[str, float] | None = None,
    fallback: str | None = None,
    least_time: float | None = None,
    hurried: bool = False,
    missed: Sequence[float] = (),
) -> Summary:
    """The numbers of summary.json, unrounded; what follows `timing` is of the plan.

    `missed` is how far from the goal each of several walks ended [m].
    """
    walk, achieved = evaluation.walk, evaluation.achieved
    setup, scenario = walk.setup, walk.setup.scenario
    recording, dt = walk.recording, setup.limits.timestep
    pose, goal = achieved.pose[-1], scenario.goal
    swings = [p for p in walk.phases if p.kind == "swing"]
    off_goal, length, walked = {}, scenario.path.length, walk.distance
    if goal is None:
        length = walked = evaluation.way
    else:
        off_goal["goal"] = deviations.departure(pose, np.array(goal))
    switches, fastest = phases.commanded_pace(walk)
    strokes = phases.swing_travel(swings, setup.robot.groups, loaded=True)
    slip, judged = achieved.slip[-1], evaluation.judged
    swung = float(sum(phases.phase_slip(walk, p).sum() for p in swings))
    legs = map(str, setup.robot.legs)
    absent: dict[str, None] = dict.fromkeys(evaluation.unpredicted)
    errors: dict[str, Departure | None] = {}
    predicted, sources = dict[str, Predicted](), dict[str, dict[str, list[float]]]()
    for name, made in evaluation.predicted.items():
        clear = evaluation.least_clearance(name)
        predicted[name] = phases.foreseen(walk, name, made, judged, clear)
        ways = achieved.pose[judged], made.pose[judged]
        errors[name] = deviations.off(*ways, length, walked)
        if not scenario.replan:  # an error that adds up, from one plan
            sources[name] = deviations.error_sources(walk, achieved.pose, made)
    if (real := evaluation.measured) is not None and real.pose is not None:
        ways = achieved.pose[evaluation.walking], real.pose[evaluation.walking]
        off_goal["measured"] = deviations.off(*ways, length, walked)
    return Summary(
        verdict=evaluation.verdict.word,
        verdict_text=evaluation.verdict.text,
        scenario=scenario.name,
        robot=setup.robot.name,
        **{name: getattr(scenario, name) for name in TOLD},
        stance=setup.stance,
        together=scenario.overlap_recovery,
        goal=None if goal is None else [*goal],
        path_length=length,
        distance_walked=walked,
        contact_switches=switches,
        contact_switches_achieved=phases.count_changes(walk),
        swing_travel=strokes,
        air_travel=phases.swing_travel(swings, setup.robot.groups, loaded=False),
        bounces=recording.bounces,
        wall_contacts=recording.wall_contacts,
        self_contacts=recording.self_contacts,
        saturated_segments=walk.saturated_segments,
        let_down=setup.world.let_down,
        fastest_swing=fastest,
        walk_starts=walk.starts * dt,
        predicted={**predicted, **absent},
        unpredicted=dict(evaluation.unpredicted),
        achieved=Accomplished(
            pose=pose.tolist(),
            min_margin=recording.least_margin,
            min_clearance=evaluation.least_clearance("achieved"),
            slip=float(slip.sum()),
            **phases.slip_by_phase(walk, float(slip.sum()), swung),
            slip_per_foot=dict(zip(legs, slip.tolist(), strict=True)),
            creep_floor=evaluation.creep_floor,
        ),
        error=errors | absent | off_goal,
        error_sources=None if scenario.replan else {**sources, **absent},
        servo=setup.servo.table(setup.world.servo)
        | {"feed_forward": setup.servo.feed_forward or Drive(setup).feeds_forward},
        weighed=evaluation.weighed,
        deviation=evaluation.deviation,
        feedback=deviations.sensed(walk),
        measured=phases.real_robot(walk, real),
        per_metre=deviations.per_metre(length, phases.moving_time(walk), strokes),
        simulated_time=recording.steps * dt,
        timestep=dt,
        versions=versions(),
        fallback=fallback,
        least_time=least_time,
        hurried=hurried,
        missed=list(missed),
        timing=dict(timing or {}),
    )
