"""The problem of a scenario: a robot that is to walk along a path."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from models import mobility_of
from planner import Array, Plan, PlannerError, play
from planner.optimisation import Optimiser
from planner.planning import recut
from sim.motion.poses import wrap
from sim.optimisation.formulation import (
    Coarse,
    criterion_of,
    own_deviation,
    task_of,
    tolerances,
)
from sim.optimisation.judging import Judge
from sim.planning.aiming import plan_along
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_open_loop, plan_replanned
from sim.planning.routes import routed
from sim.planning.sharing import is_shareable, shared_plan, walk_cache
from sim.planning.soundness import require_sound
from sim.preparation.effort import check_distance
from sim.preparation.reach import explained, immobile, require_reach
from sim.preparation.setup import GoalOffset, Setup
from sim.preparation.shared import Shared
from sim.problems.problem import Offer, Problem, Solution
from sim.progress import Progress, silent
from sim.scenarios.scenario import Scenario

WIDER = 1.5  # times the joint range
ROUNDED = 1.0 + 1e-9  # times a tolerance, within which it is kept


class ScenarioProblem(Problem):
    """A scenario with its robot, to be planned.

    Args:
        setup: What to walk.
        progress: Called with the stage and how much of it is done.
        shared: What earlier walks have built.
        undivided: The scenario before its path was divided to keep its bounds.
        centre: The same problem with its own goal, where this one aims beside it: its
            stratified plan and its optimiser serve both.

    Example:
        >>> from sim import ScenarioProblem, load_scenario, prepare
        >>> setup = prepare(load_scenario("line", {"path.goal": [0.1, 0.0, 0.0]}))
        >>> len(ScenarioProblem.ready(setup).solve().plan.segment_ends)
        40
    """

    def __init__(
        self,
        setup: Setup,
        progress: Progress = silent,
        shared: Shared | None = None,
        undivided: Scenario | None = None,
        centre: ScenarioProblem | None = None,
    ) -> None:
        scenario = setup.scenario
        self.scenario = undivided or scenario
        self.setup, self.progress, self.shared = setup, progress, shared
        self.centre = self if centre is None else centre
        self.objective, self.replan = scenario.optimise, scenario.replan
        self.words, self.segments = scenario.words, scenario.segments
        self.plan_time = scenario.plan_time
        self.extended, self.coordinates = setup.extended, setup.coordinates
        self.path = setup.nominal()

    @classmethod
    def ready(
        cls, setup: Setup, progress: Progress = silent, shared: Shared | None = None
    ) -> ScenarioProblem:
        """The problem of a setup, with a path that its robot can follow within bounds.

        Raises:
            UsageError: If the path is too long.
            SimulationError: If a direction in which it leads is out of reach.
            PlannerError: If there is no path, or no division of it keeps the bounds.
        """
        check_distance(setup)
        robot, described = setup.robot, setup.equations
        reach = partial(require_reach, robot, described, setup.nominal())
        with explained(robot, described):
            walk_cache(setup, shared)("reach", reach)
            setup = routed(setup)
            return cls(within_bounds(setup), progress, shared, setup.scenario)

    def beside(self, goal_offset: GoalOffset) -> ScenarioProblem:
        """The same problem, aimed a step beside the goal: x, y [m] and yaw [rad]."""
        if not any(goal_offset):
            return self.centre
        centre = self.centre
        setup = centre.setup.aimed(goal_offset)
        return ScenarioProblem(setup, self.progress, self.shared, self.scenario, centre)

    @cached_property
    def stratified(self) -> Plan:
        """The plan of the whole path; replanned from the kinematics if asked for."""
        if self.replan:
            return plan_replanned(self.setup)
        if self.shared is not None and is_shareable(self.setup):
            return shared_plan(self.setup, self.shared)
        return plan_open_loop(self.setup)

    def check(self, plan: Plan) -> None:
        """Refuse a plan that tips the robot over, or makes its legs collide."""
        cache = walk_cache(self.setup, self.shared)
        cache("sound", partial(require_sound, self.setup, plan))

    def solve(self) -> Solution:
        """Plan, check and optimise; a robot that cannot go there is told why."""
        with explained(self.setup.robot, self.setup.equations):
            return super().solve()

    @property
    def has_fallback(self) -> bool:
        """Whether the stratified plan's own motion stays within the tolerances."""
        return self.centre._keeps_tolerances

    def shortest(self) -> Plan:
        """The plan of least time, strokes or switches that was found."""
        return self.centre._optimiser.plan(self.path(1.0))

    def worth(self, plan: Plan) -> float:
        """What the scenario wants to be least."""
        return Judge(self.setup).worth(plan)

    def miss(self, plan: Plan) -> float:
        """How far the plan ends off the goal, on the exact kinematics."""
        end = play(plan.system, plan.flows, self.path(0.0))[-1]
        return miss_of(self.setup, end[:3], np.array(self.setup.scenario.path.goal))

    def changed(
        self,
        *,
        words: str | None = None,
        degree: int | None = None,
        segments: int | None = None,
        replan: bool | None = None,
    ) -> ScenarioProblem:
        """The same problem with other options."""
        given = {"words": words, "segments": segments, "replan": replan}
        new = {name: value for name, value in given.items() if value is not None}
        if replan:
            new |= {"optimise": "none", "correct": 1}
        extended = self.extended if degree is None else self.extended.to_degree(degree)
        scenario = replace(self.setup.scenario, **new)  # type: ignore[arg-type]
        setup = replace(self.setup, scenario=scenario, extended=extended)
        return ScenarioProblem(setup, self.progress)

    def attempt(self, share: float = 1.0) -> float:
        """What a stratified plan for the first part of the path misses of its end."""
        path = self.path
        if self.replan:
            planned = self.stratified
            self.check(planned)
        else:
            if share < 1:
                corners = [corner for corner in path.corners if corner < share]
                path = recut(path, np.array([0.0, *corners, share]))
            planned = plan_along(self.setup, path)
        end = play(planned.system, planned.flows, path(0.0))[-1]
        return miss_of(self.setup, end[:3], path(1.0)[:3]) / share

    def own_remedies(self) -> Iterator[Offer]:
        """Legs that have more room to swing."""
        described = self.setup.equations
        limits = {
            name: (WIDER * low, WIDER * high)
            for name, (low, high) in described.limits.items()
        }
        wider = replace(self.setup, equations=replace(described, limits=limits))
        yield "a joint range half as wide again", ScenarioProblem(wider).attempt

    def reason(self) -> str:
        """Why a robot cannot go everywhere, if it cannot."""
        robot, described = self.setup.robot, self.setup.equations
        return "; ".join(immobile(robot, mobility_of(robot, described)))

    @cached_property
    def _first_plan(self) -> Plan | None:
        try:
            return self.stratified
        except PlannerError:
            return None

    @cached_property
    def _within(self) -> tuple[float, float]:
        return tolerances(self.setup, self._first_plan)

    @cached_property
    def _keeps_tolerances(self) -> bool:
        if self._first_plan is None:
            return False
        found = own_deviation(self.setup, self._first_plan)
        position, yaw = (ROUNDED * within for within in self._within)
        return found.position <= position and found.yaw <= yaw

    @cached_property
    def _optimiser(self) -> Optimiser:
        setup = self.setup
        path = setup.equations.configurations(setup.scenario.path.undivided)
        return Optimiser(
            task_of(setup, self._within),
            criterion_of(setup),
            setup.extended,
            path,
            self.segments,
            coarse=Coarse(setup.extended, path, setup.equations.execution),
            report=lambda done: self.progress("optimising", done),
        )


def miss_of(setup: Setup, pose: Array, goal: Array) -> float:
    """How far a pose (3,) is off a goal, as a share of the way there.

    The yaw counts as the way of the feet when the body turns by it.
    """
    arm = setup.kinematics.reach
    turn = abs(setup.nominal()(1.0)[2])
    way = max(setup.scenario.path.length, arm * turn)
    off = max(math.dist(pose[:2], goal[:2]), arm * abs(wrap(pose[2] - goal[2])))
    return float(off / way) if way else 0.0
