"""The problem of a system without a body, from one configuration to another.

The duration of a plan is the time that its flows take at unit speed. On the way of the
shortest plans every coordinate stays as near to the path as the stratified plan does,
except those that are freed and the angles of legs, which recoveries move alone.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cached_property
from math import inf
from typing import get_args

import numpy as np

import models
from planner import Execution, Flow, Plan, line, optimisation, rollout
from planner.planning import chained_form, set_down
from sim.errors import UsageError
from sim.problems.problem import Problem

PLAN_TIME = 300.0  # [s]
OBJECTIVES: tuple[optimisation.Objective, ...] = get_args(optimisation.Objective)


class SystemProblem(Problem):
    """A system's problem, whose objective is time, strokes, switches or none.

    Each segment that is replanned is aimed to end where it should, not near it; a
    system in chained form ends there.
    """

    def __init__(
        self,
        problem: models.Problem,
        *,
        replan: bool = False,
        objective: str = "none",
        chained: bool = False,
        free: Collection[str] = (),
    ) -> None:
        if objective not in (*OBJECTIVES, "none"):
            wanted = f"give {', '.join(OBJECTIVES)} or none"
            raise UsageError(f"unknown objective {objective!r}", "--optimise", wanted)
        names = [str(symbol) for symbol in problem.system.state]
        for name in free:
            if name not in names:
                known = f"there are {', '.join(names)}"
                raise UsageError(f"unknown coordinate {name!r}", "--free", known)
        self.problem, self.replan, self.is_exact = problem, replan, chained
        self.free = frozenset(free)
        self.objective = "none" if chained else objective
        self.words, self.segments = problem.words, problem.segments
        self.plan_time = PLAN_TIME
        self.form = chained_form(problem.system, problem.flat) if chained else None
        self.extended = self.form.model if self.form else problem.extended
        self.path = line(*(set_down(problem.system, x) for x in problem.states))
        self.coordinates = problem.open_loop.coordinates

    @cached_property
    def stratified(self) -> Plan:
        """The plan from start to goal."""
        if self.form:
            return self.form.plan(*self.problem.states, self.segments)
        return self.problem.plan(aimed=self.replan)

    def miss(self, plan: Plan) -> float:
        """Distance from the goal over that of the start."""
        start, end, goal = plan.start, rollout(plan)[-1], plan.goal
        distance, missed = plan.system.length(np.array([goal - start, goal - end]))
        return float(missed / distance) if distance else 0.0

    def changed(self, degree: int = 0, **options: object) -> "SystemProblem":
        """The same problem with another degree, words, segments or replanning."""
        replan = bool(options.pop("replan", self.replan))
        options["degree"] = degree or self.problem.degree
        return SystemProblem(replace(self.problem, **options), replan=replan)  # type: ignore[arg-type]

    def attempt(self, share: float = 1.0) -> float:
        """What a stratified plan for the first part of the line misses of its end."""
        if share == 1:
            return self.miss(self.stratified)
        start, goal = self.problem.states
        names = map(str, self.problem.system.state)
        part = dict(zip(names, (start + share * (goal - start)).tolist(), strict=True))
        nearer = replace(self.problem, goal=part)
        return SystemProblem(nearer, replan=self.replan).attempt()

    def worth(self, plan: Plan) -> float:
        """What is to be least; the shorter of two plans with as many switches."""
        if self.objective == "switches":
            return plan.contact_switches + 1e-6 * duration(plan.flows)
        return sum(self._task.cost(f.field) * abs(f.duration) for f in plan.flows)

    def shortest(self) -> Plan:
        """The shortest plan found that deviates no farther than the stratified one."""
        (objective,) = (known for known in OBJECTIVES if known == self.objective)
        criterion = optimisation.Criterion(objective, duration)
        asked = self._task, criterion, self.extended, self.problem.path, self.segments
        return optimisation.Optimiser(*asked, execution=Execution(), hops=20).plan()

    @cached_property
    def _task(self) -> optimisation.Task:
        problem, system = self.problem, self.problem.system
        names = [str(symbol) for symbol in system.state]
        stages = optimisation.cycle(system, problem.elements)
        raised = (stage for stage in stages if stage.stratum != system.bottom)
        airs = {recovery.field for stage in raised for recovery in stage.recoveries}
        cheap = optimisation.CHEAP if self.objective == "strokes" else 1.0
        return optimisation.Task(
            system=system,
            stages=stages,
            tolerances=self._tolerances(),
            limits={names.index(name): span for name, span in problem.limits.items()},
            price={name: cheap if name in airs else 1.0 for name in system.fields},
        )

    def _tolerances(self) -> tuple[optimisation.Tolerance, ...]:
        """The stratified plan's own deviations, of x and y together and of the rest."""
        names = [str(s) for s in self.problem.system.state]
        legs = {i for i, _ in self.extended.shape.recoveries.values()}
        compared = [i for i in range(len(names)) if i not in legs]
        freed = [i for i in compared if names[i] in self.free]
        place = [i for i in compared if names[i] in ("x", "y") and i not in freed]
        groups = [place] if place else []
        groups += [[i] for i in compared if i not in (*place, *freed)]
        groups += [[i] for i in freed]
        points = self.problem.path.at(np.linspace(0.0, 1.0, 1001))
        states = rollout(self.stratified, optimisation.FLOW_SAMPLES)
        found = optimisation.deviation(states, points, groups)
        least = 0.01 * float(np.abs(points - points[0]).max())  # of its size
        return tuple(
            optimisation.Tolerance(
                tuple(group), inf if group[0] in freed else max(most, least)
            )
            for group, most in zip(groups, found, strict=True)
        )


def duration(flows: Sequence[Flow]) -> float:
    """Time of flows at unit speed."""
    return sum(abs(flow.duration) for flow in flows)
