"""The main job: plan, walk and compare. `sim.run_folder` writes the results."""

import math
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from models import Robot
from planner import Array, Plan
from sim.errors import UsageError
from sim.evaluation.assessment import Evaluation, evaluate, summarise
from sim.evaluation.quantities import describe
from sim.evaluation.summary import Summary
from sim.logs.log import Gait, Log, of_function, read_log, require_joints
from sim.logs.playing import scenario_of, within_reach
from sim.motion.poses import wrap
from sim.preparation.scheduling import check_effort
from sim.preparation.setup import GoalOffset, Setup, prepare
from sim.preparation.shared import Shared
from sim.problems.scenario import ScenarioProblem
from sim.progress import Progress, at_most, silent, stage
from sim.scenarios.predictions import PREDICTIONS
from sim.scenarios.scenario import Scenario
from sim.walking.finished import Walk
from sim.walking.walks import Walker, carry_out, expected_steps


@dataclass(frozen=True, eq=False)
class Prepared:
    """Everything that is decided before the first step."""

    scenario: Scenario  # before its path was divided to keep its bounds
    setup: Setup
    plan: Plan | None  # of the whole path; None if segments are planned on the way
    steps: int  # of the physics; an estimate if it plans on the way
    fallback: str | None  # why a plan is stratified where a shorter one was asked for
    least_time: float | None = None  # [s] of any plan within the same tolerances
    hurried: bool = False  # whether the search for the plan was ended early


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scenario that was carried out: plan, walk and comparison.

    Attributes:
        prepared: What was decided beforehand.
        evaluation: The walk beside its predictions.
        timing: Seconds by stage.
        missed: How far from the goal each walk ended [m], the last one last.

    Example:
        >>> from sim import load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> done = simulate(load_scenario("line", short), without=("identified",))
        >>> list(done.evaluation.predicted)
        ['ideal', 'quasi_static', 'compliant']
    """

    prepared: Prepared
    evaluation: Evaluation
    timing: dict[str, float]
    missed: tuple[float, ...]

    @property
    def plan(self) -> Plan | None:
        """Flows of the whole path; None if segments were planned on the way."""
        return self.prepared.plan

    @property
    def walk(self) -> Walk:
        """The walk in the physics."""
        return self.evaluation.walk

    @cached_property
    def summary(self) -> Summary:
        """The numbers of summary.json."""
        prepared, timing = self.prepared, self.timing
        planned = prepared.fallback, prepared.least_time, prepared.hurried
        return summarise(self.evaluation, timing, *planned, missed=self.missed)

    def __str__(self) -> str:
        return describe(self.summary)


class Witness(Protocol):
    """Receives the results of a simulation as they arise, even if it fails."""

    def prepared(self, prepared: Prepared) -> None:
        """Called when everything is decided and nothing has moved yet."""

    def walked(self, walker: Walker) -> None:
        """Called when the walk has ended or failed."""


def simulate(
    scenario: Scenario,
    *,
    robot: Robot | None = None,
    progress: Progress = silent,
    witness: Witness | None = None,
    without: Collection[str] = (),
    shared: Shared | None = None,
    log: Log | None = None,
) -> Simulation:
    """Carry out a scenario.

    Args:
        scenario: What to walk.
        robot: The scenario's robot, if it is loaded already.
        progress: Called with each stage and the finished part of it.
        witness: Receives the results before and after the walk.
        without: Comparisons to leave out, which cost physics of their own: the
            prediction `identified`, and `creep_floor`.
        shared: What earlier walks have built.
        log: The log of its `motion`, if that is read already.

    Raises:
        PlannerError: If there is no plan.
        ModelError: If the robot cannot be used.
        UsageError: If the walk takes more steps or memory than there can be.
        SimulationError: If the robot cannot go there, the plan tips it over or makes
            legs collide, or the physics diverges.

    Example:
        >>> from sim import load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> done = simulate(load_scenario("line", short), without=("identified",))
        >>> done.summary["verdict"]
        'arrived'
    """
    if {*PREDICTIONS} & {*without}:
        kept: Any = [p for p in scenario.predictions or PREDICTIONS if p not in without]
        scenario = replace(scenario, predictions=tuple(kept) or ("ideal",))
    timing = dict.fromkeys(("compile", "plan", "simulate", "evaluate"), 0.0)
    with _timed(timing, "compile"), stage(progress, "compiling"):
        setup = prepare(scenario, robot, shared, log)
    problem = None
    if setup.motion is not None:  # it is played: there is no plan, and no goal to miss
        shared = None
    else:
        with _timed(timing, "plan"), at_most(progress, "planning", scenario.plan_time):
            problem = ScenarioProblem.ready(setup, progress, shared)
        scenario = problem.scenario
    walks, missed = scenario.correct if problem else 1, list[float]()
    for number in range(1, walks + 1):
        with _timed(timing, "plan"), at_most(progress, "planning", scenario.plan_time):
            prepared = _prepared(setup, problem)
        if witness is not None and number == 1:
            witness.prepared(prepared)
        cache = prepared.setup.walk_cache(shared)
        walker, finished = Walker(prepared.setup, progress, cache), False
        try:
            walk = carry_out(walker, prepared.plan)
            finished = True
        finally:
            if witness is not None and (number == walks or not finished):
                witness.walked(walker)
        timing["plan"] += walk.seconds["plan"]
        timing["simulate"] += walk.seconds["simulate"]
        if problem:
            missed.append(math.dist(walker.pose[:2], scenario.path.goal[:2]))
            problem = problem.beside(_further(walker.setup, walker.pose))
    with _timed(timing, "evaluate"):
        evaluation = evaluate(walk, without, shared, progress)
    return Simulation(prepared, evaluation, timing, tuple(missed))


def play(
    robot: Robot,
    motion: Log | Gait | str | Path,
    duration: float = 10.0,
    progress: Progress = silent,
    **changes: object,
) -> Simulation:
    """Play joint motion from elsewhere.

    Args:
        robot: Robot whose joints move.
        motion: A log, the path of its file in radians, or a function that gives the
            angle of each joint [rad], by its name, at a time [s].
        duration: How long a function is played [s].
        progress: Called with each stage and the finished part of it.
        **changes: Settings of a scenario that replace their defaults.

    Raises:
        UsageError: If the motion or a setting is impossible.
        OSError: If its file cannot be read.
        ModelError: If the robot cannot be used.
        SimulationError: If the physics diverges.

    Example:
        >>> from models import load
        >>> from sim import play
        >>> done = play(load("hexapod"), lambda t: {"lift_1": 0.1 * t}, 0.5)
        >>> done.summary.goal is None
        True
    """
    file = Path("motion.csv")
    if isinstance(motion, str | Path):
        file = Path(motion)
        motion = read_log(file, robot.card.joints, robot.legs)
    elif not isinstance(motion, Log):
        try:
            motion = of_function(motion, duration)
            require_joints(motion.joints, robot.card.joints)
        except ValueError as error:
            raise UsageError.at("the gait", error) from error
    scenario = scenario_of(robot, file, changes)
    return simulate(
        scenario, robot=robot, progress=progress, log=within_reach(motion, robot)
    )


def _prepared(setup: Setup, problem: ScenarioProblem | None) -> Prepared:
    plan, fallback = None, None
    scenario = setup.scenario
    if problem is not None:
        setup, scenario = problem.setup, problem.scenario
        if not problem.replan:
            solution = problem.solve()
            plan, fallback = solution.plan, solution.fallback
    steps = expected_steps(setup, plan)
    check_effort(setup, steps)
    least = problem.least_time if problem else None
    hurried = problem is not None and problem.is_hurried
    return Prepared(scenario, setup, plan, steps, fallback, least, hurried)


def _further(setup: Setup, reached: Array) -> GoalOffset:
    """Where to aim next, from where a walk has ended."""
    miss = np.array(setup.scenario.path.goal) - reached
    offset = np.array(setup.goal_offset) + [*miss[:2], float(wrap(miss[2]))]
    x, y, yaw = offset.tolist()
    return x, y, yaw


@contextmanager
def _timed(timing: dict[str, float], stage: str) -> Iterator[None]:
    began = time.perf_counter()
    yield
    timing[stage] += time.perf_counter() - began
