"""The problem of a scenario: a robot that is to walk along a path."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from models import mobility_of
from planner import Array, Plan, PlannerError, RangeError, play
from planner.optimisation import FLOW_SAMPLES, Optimiser
from planner.planning import recut
from sim.motion.poses import PathDeviation, path_deviation, wrap
from sim.optimisation.judging import Judge, criterion_of, task_of
from sim.optimisation.lower_bound import least_time
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_along, plan_open_loop, plan_replanned, unaimed
from sim.planning.routes import routed
from sim.planning.soundness import require_sound
from sim.preparation.reach import explained, immobile, require_reach
from sim.preparation.scheduling import check_distance
from sim.preparation.setup import GoalOffset, Setup
from sim.preparation.shared import PLAN, Shared
from sim.problems.problem import Offer, Problem, Solution
from sim.progress import Progress, silent
from sim.scenarios.scenario import Scenario
from sim.walking.finished import Ahead

WIDER = 1.5  # times the joint range
LEAST_POSITION, LEAST_YAW = 1e-3, 1e-2  # [m], [rad]; of a tolerance that is not given
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
        centre: "ScenarioProblem | None" = None,
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
    ) -> "ScenarioProblem":
        """The problem of a setup, with a path that its robot can follow within bounds.

        Paths that are too long, out of reach, or within no bounds are refused.
        """
        check_distance(setup)
        robot, described = setup.robot, setup.equations
        reach = partial(require_reach, robot, described, setup.nominal())
        with explained(robot, described):
            setup.walk_cache(shared)("reach", reach)
            setup = routed(setup)
            divided, planned = within_bounds(setup)
            problem = cls(divided, progress, shared, setup.scenario)
        if planned is not None:
            problem.stratified = planned
        return problem

    def beside(self, goal_offset: GoalOffset) -> "ScenarioProblem":
        """The same problem, aimed a step beside the goal: x, y [m] and yaw [rad]."""
        if not any(goal_offset):
            return self.centre
        centre = self.centre
        setup = replace(centre.setup, goal_offset=goal_offset)
        return ScenarioProblem(setup, self.progress, self.shared, self.scenario, centre)

    @cached_property
    def stratified(self) -> Plan:
        """The plan of the whole path; replanned from the kinematics if asked for."""
        if self.replan:
            return plan_replanned(self.setup)
        make = partial(plan_open_loop, self.setup)
        if self.shared is None or not self.setup.is_shareable:
            return make()
        key = self.setup.robot, self.setup.scenario.key(*PLAN, "refusal")
        return self.shared.cached("plan", key, make)

    def check(self, plan: Plan) -> None:
        """Refuse a plan that tips the robot over, or makes its legs collide."""
        cache = self.setup.walk_cache(self.shared)
        cache("sound", partial(require_sound, self.setup, plan))

    def solve(self) -> Solution:
        """Plan, check and optimise; a robot that cannot go there is told why."""
        with explained(self.setup.robot, self.setup.equations):
            return self._aimed() if self.scenario.is_aimed else super().solve()

    def _aimed(self) -> Solution:
        """The solution that the compliant prediction sees end closest to the goal."""
        offset, wanted = self.setup.goal_offset, self.path(1.0)[:3]
        tried: list[tuple[float, Solution]] = []
        for _ in range(4):  # each misses a tenth of what the one before does
            problem = self.beside(offset)
            try:
                found = super(ScenarioProblem, problem).solve()
            except RangeError:
                if not tried:
                    raise
                least = min(miss for miss, _ in tried)
                raise unaimed(self.setup, "the plan", least) from None
            missed = self.centre._ahead.end(problem.setup, found.plan) - wanted
            missed[2] = wrap(missed[2])
            tried.append((float(np.abs(missed).max()), found))
            if tried[-1][0] < 1e-5:  # [m] and [rad] that a plan may be foreseen to miss
                break
            x, y, yaw = (np.array(offset) - missed).tolist()
            offset = x, y, yaw
        return min(tried, key=lambda miss: miss[0])[1]

    @cached_property
    def _ahead(self) -> Ahead:
        return Ahead(self.setup)

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

    def changed(self, degree: int = 0, **options: object) -> "ScenarioProblem":
        """The same problem with another degree, words, segments or replanning."""
        if "replan" in options:
            options |= {"optimise": "none", "correct": 1}
        extended = self.extended.to_degree(degree) if degree else self.extended
        scenario = replace(self.setup.scenario, **options)  # type: ignore[arg-type]
        setup = replace(self.setup, scenario=scenario, extended=extended)
        return ScenarioProblem(setup, self.progress)

    def attempt(self, share: float = 1.0) -> float:
        """What a stratified plan for the first part of the path misses of its end."""
        path = self.path
        if self.replan or (share == 1 and self.words != "printed"):  # which is aimed
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
        ends = described.limits.items()
        limits = {name: (WIDER * low, WIDER * high) for name, (low, high) in ends}
        wider = replace(self.setup, equations=replace(described, limits=limits))
        yield "a joint range half as wide again", ScenarioProblem(wider).attempt

    def reason(self) -> str:
        """Why a robot cannot go everywhere, if it cannot."""
        robot = self.setup.robot
        return "; ".join(immobile(robot, mobility_of(robot, self.setup.equations)))

    @property
    def has_fallback(self) -> bool:
        """Whether the stratified plan's own motion stays within the tolerances."""
        own = self.centre._own_deviation
        position, yaw = (ROUNDED * within for within in self.centre.within)
        return own is not None and own.position <= position and own.yaw <= yaw

    @cached_property
    def _own_deviation(self) -> PathDeviation | None:
        """The stratified plan's from the nominal path, by the fields it is of."""
        try:
            plan = self.stratified
        except PlannerError:
            return None
        states = play(plan.system, plan.flows, plan.start, FLOW_SAMPLES)
        return path_deviation(self.setup.scenario.path.curve, states[:, :3])

    @cached_property
    def within(self) -> tuple[float, float]:
        """Largest deviation of the walk from the path [m], and from its yaw [rad].

        Where none is given, that of the stratified plan stands.
        """
        scenario, own = self.setup.scenario, self._own_deviation
        position, yaw = scenario.path_tolerance, scenario.yaw_tolerance
        if position is None:
            position = max(LEAST_POSITION, own.position if own else 0.0)
        if yaw is None:
            yaw = max(LEAST_YAW, own.yaw if own else 0.0)
        return position, yaw

    @cached_property
    def least_time(self) -> float | None:
        """Time that no plan within the tolerances falls below [s], if one is sought."""
        if self.objective == "none":
            return None
        return least_time(self.centre.setup, *self.centre.within)

    @property
    def is_hurried(self) -> bool:
        """Whether the search for an optimised plan was ended early."""
        return self.objective != "none" and self.centre._optimiser.is_hurried

    @cached_property
    def _optimiser(self) -> Optimiser:
        setup = self.setup
        return Optimiser(
            task_of(setup, self.within),
            criterion_of(setup),
            setup.extended,
            setup.equations.configurations(setup.scenario.path.undivided),
            self.segments,
            execution=setup.equations.execution,
            report=lambda done: self.progress("optimising", done),
            hops=setup.scenario.hops,
        )


def miss_of(setup: Setup, pose: Array, goal: Array) -> float:
    """How far a pose (3,) is off a goal, as a share of the way; yaw counts by feet."""
    arm = setup.kinematics.reach
    way = max(setup.scenario.path.length, arm * abs(setup.nominal()(1.0)[2]))
    off = max(math.dist(pose[:2], goal[:2]), arm * abs(wrap(pose[2] - goal[2])))
    return float(off / way) if way else 0.0
