"""Violations between the points where a program checks its constraints, and margins.

A program checks the corridor after a few steps of every stage, and inequalities at its
ends. Here the motion is checked after many, and margins grow in the stages in need.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.errors import message
from planner.numerics.arrays import Array
from planner.optimisation.constraints import Margins, stage_function, whole_state
from planner.optimisation.corridor import gaps
from planner.optimisation.solver import Expression, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task, built_once
from planner.planning.paths import Path

FINE_STEPS = 12  # of a stage
PATH_POINTS = 1001  # at which a motion is compared with its path
GUARD = 1e-3  # further share of a tolerance, since larger margins move the plan


@dataclass(frozen=True, eq=False)
class Violations:
    """Violations of tolerances and inequalities by an exact motion."""

    excess: float  # largest deviation from the path, in tolerances
    lacks: Array  # violation of each of the task's inequalities, shape (R,)

    @property
    def none(self) -> bool:
        """Whether all constraints are satisfied."""
        return self.excess <= 1.0 and not (self.lacks > 0.0).any()

    def message(self, task: Task) -> str:
        """What is violated, and the way out."""
        names = [
            f"lacks {lack:.3g} of its {inequality.name}"
            for lack, inequality in zip(self.lacks, task.inequalities, strict=True)
            if lack > 0.0
        ]
        if self.excess > 1.0:
            names = [f"deviates {self.excess - 1:.2%} more than allowed", *names]
        return message("between_points", what=" and ".join(names))


def _violating(excess: Array) -> Array:
    """Stages with a positive excess, or all if there are none, along the first axis."""
    return np.asarray((excess > 0.0) | ~(excess > 0.0).any(axis=0))


@dataclass(frozen=True)
class Refinement:
    """Enlarges the margins of the stages whose motion violates constraints."""

    task: Task
    path: Path

    def enlarged(
        self,
        before: Sequence[Margins],
        solutions: Sequence[Solution],
        violations: Violations,
    ) -> list[Margins]:
        """Margins of consecutive solutions, enlarged in the stages at fault.

        A violation that no stage accounts for enlarges the margins of all stages.
        """
        if violations.none:
            return list(before)
        starts = np.cumsum([len(solution.strokes) for solution in solutions])[:-1]
        checked = [
            self._checked(solution, k)
            for solution in solutions
            for k in range(len(solution.strokes))
        ]
        over = np.maximum(1.0, self._widths(solutions, [part for part, _ in checked]))
        shares = np.ones(len(checked))
        if violations.excess > 1.0:
            more = max(1.0, violations.excess / over.max())
            shares = np.where(_violating(over - 1.0), 1.0 / (over * more + GUARD), 1.0)
        own = np.array([lacks for _, lacks in checked])
        more = np.maximum(violations.lacks - own.max(axis=0), 0.0)
        lacks = np.where(_violating(own) & (violations.lacks > 0.0), own + more, 0.0)
        parts = np.split(shares, starts), np.split(lacks, starts)
        return list(map(Margins.enlarged, before, *parts))

    def _widths(self, solutions: Sequence[Solution], parts: Sequence[Array]) -> Array:
        """Largest deviation of the states of each stage, in tolerances.

        The position is compared with the places that belong to it in the solutions.
        """
        groups = [list(tolerance.coordinates) for tolerance in self.task.tolerances]
        points = self.path.at(np.linspace(0.0, 1.0, PATH_POINTS))
        states = np.tile(points[0], (sum(map(len, parts)), 1))
        states[:, self.task.moved] = np.vstack(parts)
        found = gaps(states, points, groups)
        share = np.arange(1, FINE_STEPS + 1) / FINE_STEPS
        places = [
            s.places[:-1, None] + np.diff(s.places)[:, None] * share for s in solutions
        ]
        apart = states - self.path.at(np.concatenate([p.ravel() for p in places]))
        found[:, 0] = np.linalg.norm(apart[:, groups[0]], axis=1)
        widths = (found / [t.most for t in self.task.tolerances]).max(axis=1)
        return np.array([part.max() for part in np.split(widths, len(parts))])

    def _checked(self, solution: Solution, number: int) -> tuple[Array, Array]:
        """States within a stage, shape (FINE_STEPS, m), and violations, shape (R,)."""
        stage = self.task.stage(solution.first + number)
        begin = solution.states[number][self.task.moved]
        given = [begin, solution.strokes[number], solution.recoveries[number]]
        states, *lacks = _between(self.task, stage, self.path(0.0)).call(given)
        return np.array(states).T, np.array([np.array(lack).max() for lack in lacks])


@built_once
def _between(task: Task, stage: Stage, start: Array) -> Expression:
    """States and violations at many steps, from start, stroke and recoveries."""
    ca, n = solver(), len(task.moved)
    x, d = ca.MX.sym("x", n), ca.MX.sym("d")
    a = ca.MX.sym("a", task.most_recoveries)
    y, lacks = ca.SX.sym("y", n), list[Expression]()
    moved = stage_function(task, stage, start, FINE_STEPS)
    steps = moved(x, d, a)
    halfway = x if task.overlapped else moved(x, 0.0, a / 2)[:, -1]
    every = ca.horzcat(x, halfway, steps)
    whole = whole_state(task, start, y)
    for inequality in task.inequalities:
        rows = ca.vertcat(ca.SX(0.0), *inequality.expressions(stage, whole))
        lacks.append(-ca.Function("rows", [y], [rows]).map(every.shape[1])(every))
    return ca.Function("between", [x, d, a], [steps, *lacks])
