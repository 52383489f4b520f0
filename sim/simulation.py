"""The main job: plan, walk and compare. Writes nothing; `sim.run_folder` does."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from models import Robot
from planner import Plan
from sim.evaluation.assessment import Evaluation, Summary, evaluate, summarise
from sim.evaluation.comparison import describe
from sim.experiments.creep import creep_floor
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_open_loop
from sim.planning.routes import routed
from sim.preparation.effort import check_effort
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, silent
from sim.scenarios.scenario import Scenario
from sim.walking.finished import Walk
from sim.walking.walker import Walker, carry_out, expected_steps


@dataclass(frozen=True, eq=False)
class Prepared:
    """Everything that is decided before the first step.

    Attributes:
        scenario: What is to be walked, before its path was divided for its bounds.
        setup: What the scenario has come to.
        plan: Flows of the whole path; None where segments are planned on the way.
        steps: Physics steps that the walk will take; where it plans on the way, about.
    """

    scenario: Scenario
    setup: Setup
    plan: Plan | None
    steps: int


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scenario carried out: what was planned, what was walked, how they compare.

    Attributes:
        prepared: What was decided beforehand.
        evaluation: The walk beside its predictions.
        creep_floor: Slip of a robot that stands still as long [m].
        timing: Seconds by stage.
    """

    prepared: Prepared
    evaluation: Evaluation
    creep_floor: float
    timing: dict[str, float]

    @property
    def plan(self) -> Plan | None:
        """Flows of the whole path; None where segments were planned on the way."""
        return self.prepared.plan

    @property
    def walk(self) -> Walk:
        """What the robot did."""
        return self.evaluation.walk

    @cached_property
    def summary(self) -> Summary:
        """The numbers of summary.json."""
        numbers = summarise(self.evaluation, self.creep_floor)
        return numbers | {"timing": self.timing}

    def __str__(self) -> str:
        return describe(self.summary)


class Witness(Protocol):
    """Somebody who keeps what a simulation comes to, also of one that fails."""

    def prepared(self, prepared: Prepared) -> None:
        """Everything is decided, nothing has moved yet."""
        ...

    def walked(self, walker: Walker) -> None:
        """The walk is over, at its end or where it failed."""
        ...


def simulate(
    scenario: Scenario,
    *,
    robot: Robot | None = None,
    progress: Progress = silent,
    witness: Witness | None = None,
) -> Simulation:
    """Carry a scenario out.

    Args:
        scenario: What to walk.
        robot: The scenario's robot, if it is loaded already.
        progress: Told the stage and how much of it is done.
        witness: Shown what there is before and after the walk.

    Raises:
        PlannerError: If there is no plan.
        ModelError: If the robot cannot be used.
        UsageError: If the walk takes more steps or memory than there can be.
        SimulationError: If the physics diverges.
    """
    timing: dict[str, float] = {}
    with _timed(timing, "compile"):
        setup = prepare(scenario, robot)
    with _timed(timing, "plan"):
        prepared = _planned(setup)
    if witness is not None:
        witness.prepared(prepared)
    walker = Walker(prepared.setup, progress)
    try:
        walk = carry_out(walker, prepared.plan)
    finally:
        if witness is not None:
            witness.walked(walker)
    timing["plan"] += walk.seconds["plan"]
    timing["simulate"] = walk.seconds["simulate"]
    with _timed(timing, "evaluate"):
        evaluation = evaluate(walk)
        floor = creep_floor(prepared.setup, walk.duration)
    return Simulation(prepared, evaluation, floor, timing)


def _planned(setup: Setup) -> Prepared:
    setup = routed(setup)
    scenario = setup.scenario
    setup = within_bounds(setup)
    plan = None if scenario.replan else plan_open_loop(setup)
    steps = expected_steps(setup, plan)
    check_effort(setup, steps)
    return Prepared(scenario, setup, plan, steps)


@contextmanager
def _timed(timing: dict[str, float], stage: str) -> Iterator[None]:
    began = time.perf_counter()
    yield
    timing[stage] = time.perf_counter() - began
