"""The shortest plan found along a path: searched for, made exact, and checked."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from operator import is_not
from typing import Literal

import numpy as np

from planner.errors import BoundError, message
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.optimisation.constraints import Margins
from planner.optimisation.corridor import deviation
from planner.optimisation.refinement import PATH_POINTS, Refinement, Violations
from planner.optimisation.search import Search
from planner.optimisation.task import Solution, Task
from planner.optimisation.windows import Report
from planner.planning.algorithm import Plan, plan, plan_of_flows
from planner.planning.paths import Path
from planner.planning.rollouts import play
from planner.support.stopping import answer, unlimited
from planner.systems.flows import Flow, contact_switches, merged

Objective = Literal["time", "strokes", "switches"]

FLOW_SAMPLES = 8  # states of a flow that are compared with the path


@dataclass(frozen=True)
class Criterion:
    """The objective to minimise, and how flows in time order are measured.

    The final state of flows is predicted by rollout on the task's system if not given.
    `complete` adds flows in between to those of each segment, such as repositioning of
    legs.
    """

    objective: Objective
    duration: Callable[[Sequence[Flow]], float]
    predict: Callable[[Sequence[Flow]], Array] | None = None
    complete: Callable[[Sequence[Sequence[Flow]]], list[list[Flow]]] | None = None


class Optimiser:
    """Strokes and recoveries that follow a path at the least cost.

    The search takes place once; plans for nearby goals start from its solutions. The
    plan names elements and basis of the extended system, and has a number of segments
    of the path to which flows are assigned. Coarse stratified plans, carried out by
    `execution`, give first guesses. From the best plan of every window the search hops
    to others, `hops` times. `report` is called with the share of the work that is done.
    """

    def __init__(
        self,
        task: Task,
        criterion: Criterion,
        extended: ExtendedSystem,
        path: Path,
        segments: int,
        *,
        execution: Execution | None = None,
        report: Report = lambda done: None,
        hops: int = 0,
    ) -> None:
        self.task, self.criterion, self.extended = task, criterion, extended
        self.path, self.segments = path, segments

        def coarse(begin: float, end: float, count: int) -> Sequence[Flow]:
            piece = Path(lambda s: path.at(begin + (end - begin) * s))
            return plan(extended, piece, count, execution=execution).flows

        guessed = coarse if execution else None
        self._search = Search(task, path, self.score, guessed, report, hops)
        self._refinement = Refinement(task, path)

    @property
    def is_hurried(self) -> bool:
        """Whether Ctrl-C or the end of the time to plan in has ended the search."""
        return self._search.hurried

    @cached_property
    def _solutions(self) -> list[Solution]:
        return self._search.run()

    @cached_property
    def _best(self) -> "Optimiser":
        """The optimiser whose plan, played exactly, is best: for no larger tolerance.

        Those for rounded tolerances are the same for all larger ones, so that none of
        these takes longer, whatever refinement makes of a plan.
        """
        given = self.criterion, self.extended, self.path, self.segments
        values = list[tuple[float, int, Optimiser]]()
        for number, (task, solution) in enumerate(self._search.found):
            other = Optimiser(task, *given)
            other._solutions = [solution]
            with suppress(BoundError):
                flows = other._refined([solution], self.path(1.0))
                values.append((self._value(flows, solution), number, other))
        return min(values)[2] if values else self

    def score(self, solution: Solution) -> float:
        """Value of the objective for a solution."""
        return self._value(self.flows([solution]), solution)

    def _value(self, parts: Sequence[Sequence[Flow]], solution: Solution) -> float:
        """Value of the objective for flows in segments, and what they are made of."""
        if self.criterion.objective == "strokes":
            return solution.cost
        flows = list(chain(*parts))
        duration = self.criterion.duration(flows)
        if self.criterion.objective == "time":
            return duration
        return contact_switches(self.task.system, flows) + 1e-6 * duration

    def flows(self, solutions: Sequence[Solution]) -> list[list[Flow]]:
        """Flows of each segment, assigned by the middle of their stages on the path."""
        parts: list[list[Flow]] = [[] for _ in range(self.segments)]
        for solution in solutions:
            for k, stroke in enumerate(solution.strokes.tolist()):
                stage = self.task.stage(solution.first + k)
                middle = float(np.mean(solution.places[k : k + 2]))
                segment = min(int(middle * self.segments), self.segments - 1)
                parts[segment] += stage.flows(stroke, solution.recoveries[k].tolist())
        complete = self.criterion.complete
        return complete(parts) if complete else parts

    def plan(self, goal: Array | None = None) -> Plan:
        """The plan, refined until its exact motion meets the goal and constraints.

        Stages whose exact motion violates them, between the few steps in which the
        program checks them, are solved again with larger margins. The goal, shape (n,),
        is the path's own unless another is given. A `BoundError` says that no plan
        keeps the tolerances, or none that was found when it is played exactly.
        """
        goal = self.path(1.0) if goal is None else goal
        _ = self._solutions
        with unlimited():  # what was found in time is not to be lost now
            best = self._best
            joined = [merged(part) for part in best._refined(best._solutions, goal)]
        nominal = self.path.at(np.linspace(0.0, 1.0, self.segments + 1))
        nominal[-1] = goal
        elements, basis = self.extended.elements, self.extended.steering.basis
        return plan_of_flows(self.task.system, elements, joined, nominal, basis)

    def _refined(self, solutions: Sequence[Solution], goal: Array) -> list[list[Flow]]:
        """Flows of each segment whose exact motion meets the goal and constraints."""
        aim, best, interrupted = goal, None, False
        margins: Sequence[Margins] = [
            Margins.none(self.task, len(s.strokes)) for s in solutions
        ]
        sizes = self.task.sizes(self.path(0.0))
        for left in reversed(range(12)):  # refinements
            flows = self.flows(solutions)
            end, violations = self._played(flows)
            miss = goal - end
            off = float(np.abs(miss[self.task.moved] / sizes).max())
            if violations.none and (best is None or off < best[0]):
                best = off, flows
            if left == 0 or (violations.none and off < 1e-6):  # of a stroke's length
                break
            aim = aim + miss
            before = margins
            margins = self._refinement.enlarged(before, solutions, violations)
            changed = list(map(is_not, margins, before))
            try:
                found = self._again(solutions, margins, [*changed[:-1], True], aim)
            except KeyboardInterrupt as stop:
                if best is None or type(stop) is not KeyboardInterrupt:
                    raise
                answer(stop)
                interrupted = True
                break
            if found is None:
                break
            solutions, margins = found
        if best is None:
            raise BoundError(f"the best plan found {violations.message(self.task)}")
        if best[0] > 1e-2 and not interrupted:  # likewise
            raise BoundError(message("best_misses", missed=best[0]))
        return best[1]

    def _again(
        self,
        solutions: Sequence[Solution],
        margins: Sequence[Margins],
        changed: Sequence[bool],
        aim: Array,
    ) -> tuple[list[Solution], list[Margins]] | None:
        """Solutions with margins, some of them solved again, the last for an aim.

        Where a window has no solution between its ends, all are solved as one.
        """
        goals = [*(s.states[-1] for s in solutions[:-1]), aim]
        found = list[Solution]()
        for number, solution in enumerate(solutions):
            given = solution, goals[number], margins[number]
            again = self._search.again(*given) if changed[number] else solution
            if again is None:
                break
            found.append(again)
        else:
            return found, list(margins)
        if len(solutions) == 1:
            return None
        asked = Margins.joined(margins)
        again = self._search.again(Solution.joined(solutions), aim, asked)
        return ([again], [asked]) if again else None

    def _played(self, flows: Sequence[Sequence[Flow]]) -> tuple[Array, Violations]:
        """Where the exact motion of flows ends, and which constraints it violates."""
        system, start, joined = self.task.system, self.path(0.0), merged(chain(*flows))
        predict = self.criterion.predict
        end = predict(joined) if predict else play(system, joined, start)[-1]
        states = play(system, joined, start, FLOW_SAMPLES)
        points = self.path.at(np.linspace(0.0, 1.0, PATH_POINTS))
        tolerances, inequalities = self.task.tolerances, self.task.inequalities
        found = deviation(states, points, [t.coordinates for t in tolerances])
        excess = max(f / t.most for f, t in zip(found, tolerances, strict=True))
        return end, Violations(excess, np.array([i.lack(flows) for i in inequalities]))
