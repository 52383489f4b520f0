"""The shortest plan found along a path: searched for, made exact, and checked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from planner.errors import BoundError
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.optimisation.between import Between, Exact
from planner.optimisation.corridor import deviation
from planner.optimisation.guesses import Coarse
from planner.optimisation.requirements import Demands
from planner.optimisation.search import Search
from planner.optimisation.task import Solution, Task
from planner.optimisation.windows import Report
from planner.planning.algorithm import Plan
from planner.planning.paths import Path
from planner.planning.rollouts import play
from planner.support.stopping import answer, unlimited
from planner.systems.flows import Flow, contact_switches, merged

Objective = Literal["time", "strokes", "switches"]
Completion = Callable[[Sequence[Sequence[Flow]]], list[list[Flow]]]
"""Flows of each segment with those that belong between, such as legs set anew."""

ROUNDS = 12  # of making a plan exact
MISS = 1e-6  # of the goal, in units that a stroke moves by
FAR = 1e-2  # of the goal, which no plan misses by as much
SAMPLES = 8  # of a flow, where a motion is compared with its path
POINTS = 1001  # of the path, likewise


@dataclass(frozen=True)
class Criterion:
    """What is to be least, and how flows are measured.

    Attributes:
        objective: What is to be least.
        duration: Time that flows in their order take.
        predict: State that flows lead to; played on the task's system if not given.
        complete: Adds what belongs between the flows; nothing is added if not given.
    """

    objective: Objective
    duration: Callable[[Sequence[Flow]], float]
    predict: Callable[[Sequence[Flow]], Array] | None = None
    complete: Completion | None = None


class Optimiser:
    """Strokes and recoveries that follow a path at the least cost.

    What has been searched for is kept, so that plans for other goals, nearby, come at
    the cost of a solution.

    Args:
        task: Fields, stages, tolerances, and what else must hold.
        criterion: What is to be least.
        extended: Elements and basis that the plan is said to be of.
        path: Configurations to follow.
        segments: Number of pieces of the path that the flows are counted in.
        coarse: Stratified plans to start from.
        report: Told how much of the work is done, from 0 to 1.
    """

    def __init__(
        self,
        task: Task,
        criterion: Criterion,
        extended: ExtendedSystem,
        path: Path,
        segments: int,
        *,
        coarse: Coarse | None = None,
        report: Report = lambda done: None,
    ) -> None:
        self.task, self.criterion, self.extended = task, criterion, extended
        self.path, self.segments = path, segments
        self._search = Search(task, path, self.score, coarse, report)
        self._between = Between(task, path)

    @cached_property
    def _solutions(self) -> list[Solution]:
        return self._search.run()

    def score(self, solution: Solution) -> float:
        """What is to be least."""
        flows = [f for part in self.flows([solution]) for f in part]
        if self.criterion.objective == "strokes":
            return solution.cost
        duration = self.criterion.duration(flows)
        if self.criterion.objective == "time":
            return duration
        return contact_switches(self.task.system, flows) + 1e-6 * duration

    def flows(self, solutions: Sequence[Solution]) -> list[list[Flow]]:
        """Flows of each segment, by where on the path their stages end."""
        parts: list[list[Flow]] = [[] for _ in range(self.segments)]
        for solution in solutions:
            for k, (stroke, recoveries) in enumerate(
                zip(solution.strokes, solution.recoveries, strict=True)
            ):
                stage = self.task.stage(solution.first + k)
                middle = float(np.mean(solution.places[k : k + 2]))
                segment = min(int(middle * self.segments), self.segments - 1)
                parts[segment] += stage.flows(float(stroke), recoveries.tolist())
        complete = self.criterion.complete
        return complete(parts) if complete else parts

    def plan(self, goal: Array | None = None) -> Plan:
        """The plan, made exact: it meets its goal and keeps to what it has to keep.

        The program integrates in few steps, and looks at tolerances and inequalities
        there alone. Stages whose exact motion exceeds them in between are solved again
        with higher demands, between the states in which their window begins and ends.

        Args:
            goal: Configuration to end in, if not the path's own, shape (n,).

        Raises:
            BoundError: If no plan keeps the tolerances, or none was found that does
                when it is played exactly.
            StratumError: If a field that is needed is known as a function only.
            MissingSolverError: If CasADi is not installed.
        """
        goal = self.path(1.0) if goal is None else goal
        solutions = self._solutions
        with unlimited():  # what was found in time is not to be lost now
            return self._plan(self._made_exact(solutions, goal), goal)

    def _made_exact(
        self, solutions: Sequence[Solution], goal: Array
    ) -> list[list[Flow]]:
        """Flows of each segment that meet the goal and keep to what they have to."""
        aim, best, interrupted = goal, None, False
        demands: Sequence[Demands] = [
            Demands.none(self.task, len(s.strokes)) for s in solutions
        ]
        for left in reversed(range(ROUNDS)):
            flows = self.flows(solutions)
            miss, exact = goal - self._end(flows), self._exact(flows)
            off = self._off(miss)
            if exact.kept and (best is None or off < best[0]):
                best = off, flows
            if left == 0 or (exact.kept and off < MISS):
                break
            aim = aim + miss
            before, demands = demands, self._between.demanded(demands, solutions, exact)
            changed = [d is not b for d, b in zip(demands, before, strict=True)]
            try:
                found = self._again(solutions, demands, [*changed[:-1], True], aim)
            except KeyboardInterrupt as stop:
                if best is None or type(stop) is not KeyboardInterrupt:
                    raise
                answer(stop)
                interrupted = True
                break
            if found is None:
                break
            solutions, demands = found
        if best is None:
            raise BoundError(f"the best plan found {exact.said(self.task)}")
        if best[0] > FAR and not interrupted:
            raise BoundError(
                f"the best plan found misses its goal by {best[0]:.2g} of what a unit "
                "of its strokes moves by; give larger tolerances"
            )
        return best[1]

    def _again(
        self,
        solutions: Sequence[Solution],
        demands: Sequence[Demands],
        changed: Sequence[bool],
        aim: Array,
    ) -> tuple[list[Solution], list[Demands]] | None:
        """The solutions, of which some are solved again, and the last for an aim.

        Where a window has no such solution between its ends, all are solved as one.
        """
        goals = [*(s.states[-1] for s in solutions[:-1]), aim]
        found = list[Solution]()
        for solution, goal, asked, anew in zip(
            solutions, goals, demands, changed, strict=True
        ):
            again = self._search.again(solution, goal, asked) if anew else solution
            if again is None:
                break
            found.append(again)
        else:
            return found, list(demands)
        if len(solutions) == 1:
            return None
        whole, asked = Solution.joined(solutions), Demands.joined(demands)
        again = self._search.again(whole, aim, asked)
        return None if again is None else ([again], [asked])

    def _exact(self, flows: Sequence[Sequence[Flow]]) -> Exact:
        """How flows keep to the path, and to what else they have to keep."""
        joined = merged(flow for part in flows for flow in part)
        states = play(self.task.system, joined, self.path(0.0), SAMPLES)
        points = self.path.at(np.linspace(0.0, 1.0, POINTS))
        tolerances, inequalities = self.task.tolerances, self.task.inequalities
        found = deviation(states, points, [t.coordinates for t in tolerances])
        excess = max(f / t.most for f, t in zip(found, tolerances, strict=True))
        return Exact(excess, np.array([i.lack(flows) for i in inequalities]))

    def _off(self, miss: Array) -> float:
        sizes = self.task.sizes(self.path(0.0))
        return float(np.abs(miss[self.task.moved] / sizes).max())

    def _end(self, flows: Sequence[Sequence[Flow]]) -> Array:
        joined = merged(flow for part in flows for flow in part)
        if self.criterion.predict is not None:
            return self.criterion.predict(joined)
        return play(self.task.system, joined, self.path(0.0))[-1]

    def _plan(self, flows: list[list[Flow]], goal: Array) -> Plan:
        system = self.task.system
        joined = [merged(part) for part in flows]
        nominal = self.path.at(np.linspace(0.0, 1.0, self.segments + 1))
        nominal[-1] = goal
        elements, basis = self.extended.elements, self.extended.steering.basis
        return Plan(
            system=system,
            elements=elements,
            basis=basis,
            flows=tuple(flow for part in joined for flow in part),
            segment_ends=tuple(np.cumsum([len(part) for part in joined]).tolist()),
            inputs=np.zeros((self.segments, 0, len(elements))),
            hall_coordinates=np.zeros((self.segments, len(basis))),
            nominal=nominal,
            depart=system.bottom,
            arrive=system.bottom,
        )
