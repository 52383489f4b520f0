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
from planner.optimisation.corridor import deviation
from planner.optimisation.guesses import Coarse
from planner.optimisation.program import TIGHTER
from planner.optimisation.search import Report, Search
from planner.optimisation.task import Solution, Task
from planner.planning.algorithm import Plan
from planner.planning.paths import Path
from planner.planning.rollouts import play
from planner.systems.flows import Flow, contact_switches, merged

Objective = Literal["time", "strokes", "switches"]
Laid = Callable[[Sequence[Sequence[Flow]]], list[list[Flow]]]
"""Flows of each segment with what is left to lay, such as legs set anew between."""

ROUNDS = 6  # of making a plan exact
MISS = 1e-6  # of the goal, in units that a stroke moves by
SAMPLES = 8  # of a flow, where a motion is compared with its path
POINTS = 1001  # of the path, likewise


@dataclass(frozen=True)
class Wish:
    """What a plan is to be, and how its flows are judged.

    Attributes:
        task: Fields, stages and tolerances.
        objective: What is to be least.
        duration: Time that flows in their order take.
        predict: State that flows lead to; played on the task's system if not given.
        lay: What is laid between the flows afterwards; nothing if not given.
    """

    task: Task
    objective: Objective
    duration: Callable[[Sequence[Flow]], float]
    predict: Callable[[Sequence[Flow]], Array] | None = None
    lay: Laid | None = None


class Optimiser:
    """Strokes and recoveries that follow a path at the least cost.

    What has been searched for is kept, so that plans for other goals, nearby, come at
    the cost of a solution.

    Args:
        wish: What the plan is to be.
        extended: Elements and basis that the plan is said to be of.
        path: Configurations to follow.
        segments: Number of pieces of the path that the flows are counted in.
        coarse: Stratified plans to start from.
        report: Told how much of the work is done, from 0 to 1.
    """

    def __init__(
        self,
        wish: Wish,
        extended: ExtendedSystem,
        path: Path,
        segments: int,
        *,
        coarse: Coarse | None = None,
        report: Report = lambda done: None,
    ) -> None:
        self.wish, self.extended = wish, extended
        self.path, self.segments = path, segments
        self._search = Search(wish.task, path, self.score, coarse, report)

    @cached_property
    def _solutions(self) -> list[Solution]:
        return self._search.run()

    def score(self, solution: Solution) -> float:
        """What is to be least."""
        flows = [f for part in self.flows([solution]) for f in part]
        if self.wish.objective == "strokes":
            return solution.cost
        duration = self.wish.duration(flows)
        if self.wish.objective == "time":
            return duration
        system = self.wish.task.system
        return contact_switches(system, flows) + 1e-6 * duration

    def flows(self, solutions: Sequence[Solution]) -> list[list[Flow]]:
        """Flows of each segment, by where on the path their stages end."""
        parts: list[list[Flow]] = [[] for _ in range(self.segments)]
        for solution in solutions:
            for k, (stroke, recoveries) in enumerate(
                zip(solution.strokes, solution.recoveries, strict=True)
            ):
                stage = self.wish.task.stage(solution.first + k)
                middle = float(np.mean(solution.places[k : k + 2]))
                segment = min(int(middle * self.segments), self.segments - 1)
                parts[segment] += stage.flows(float(stroke), recoveries.tolist())
        return self.wish.lay(parts) if self.wish.lay else parts

    def plan(self, goal: Array | None = None) -> Plan:
        """The plan, aimed until its exact motion meets the goal and keeps to the path.

        The program integrates in few steps and looks at its tolerances there alone.

        Args:
            goal: Configuration to end in, if not the path's own, shape (n,).

        Raises:
            BoundError: If no plan keeps the tolerances, or none was found that does
                when it is played exactly.
            StratumError: If a field that is needed is known as a function only.
            MissingSolverError: If CasADi is not installed.
        """
        goal = self.path(1.0) if goal is None else goal
        search, solutions, task = self._search, self._solutions, self.wish.task
        aim, tighter, best = goal, TIGHTER, None
        for _ in range(ROUNDS):
            flows = self.flows(solutions)
            miss = goal - self._end(flows)
            excess = self._excess(flows)
            off = float(np.abs(miss[task.moved] / task.sizes(self.path(0.0))).max())
            if excess <= 1.0 and (best is None or off < best[0]):
                best = off, flows
            if off < MISS and excess <= 1.0:
                break
            aim = aim + miss
            tighter = tighter / excess if excess > 1.0 else tighter
            again = search.again(solutions[-1], aim, tighter)
            if again is None:
                break
            solutions = [*solutions[:-1], again]
        if best is None:
            raise BoundError(
                "the best plan found leaves its tolerances between the points where "
                "they were checked; give larger tolerances"
            )
        return self._plan(best[1], goal)

    def _end(self, flows: Sequence[Sequence[Flow]]) -> Array:
        joined = merged(flow for part in flows for flow in part)
        if self.wish.predict is not None:
            return self.wish.predict(joined)
        return play(self.wish.task.system, joined, self.path(0.0))[-1]

    def _excess(self, flows: Sequence[Sequence[Flow]]) -> float:
        """Largest deviation from the path over what is allowed."""
        joined = merged(flow for part in flows for flow in part)
        states = play(self.wish.task.system, joined, self.path(0.0), SAMPLES)
        points = self.path.at(np.linspace(0.0, 1.0, POINTS))
        found = deviation(
            states, points, [t.coordinates for t in self.wish.task.tolerances]
        )
        asked = [t.most for t in self.wish.task.tolerances]
        return max(f / a for f, a in zip(found, asked, strict=True))

    def _plan(self, flows: list[list[Flow]], goal: Array) -> Plan:
        system = self.wish.task.system
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
