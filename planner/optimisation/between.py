"""What a solution does between the moments at which its program looks at it.

A program looks at its tolerances at a few steps of every stage, and at inequalities at
the ends. Here the same is looked at in many steps, stage by stage, so that more can be
asked of the stages that need it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.dynamics import following, stage_function, whole_state
from planner.optimisation.requirements import Demands
from planner.optimisation.solver import solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path

FINE = 12  # steps of a stage
SAFE = 1e-3  # part of a tolerance asked in addition, because more moves the plan


@dataclass(frozen=True, eq=False)
class Exact:
    """How far an exact motion exceeds what it may.

    Attributes:
        excess: Largest deviation from the path over the one that is allowed.
        lacks: What it lacks to each of the task's inequalities, shape (R,).
    """

    excess: float
    lacks: Array

    @property
    def kept(self) -> bool:
        """Whether it exceeds nothing."""
        return self.excess <= 1.0 and not (self.lacks > 0.0).any()

    def said(self, task: Task) -> str:
        """What it does not keep, in words."""
        names = [
            f"lacks {lack:.3g} of its {inequality.name}"
            for lack, inequality in zip(self.lacks, task.inequalities, strict=True)
            if lack > 0.0
        ]
        if self.excess > 1.0:
            names = [f"strays {self.excess - 1:.2%} farther than it may", *names]
        return (
            f"{' and '.join(names)} between the points where it was checked; give "
            "larger tolerances, or ask for less"
        )


@dataclass
class Between:
    """Looks at the motion within stages.

    Attributes:
        task: What is optimised.
        path: Configurations to follow.
    """

    task: Task
    path: Path
    _known: dict[Stage, Any] = field(default_factory=dict)

    def demanded(
        self, before: Sequence[Demands], solutions: Sequence[Solution], exact: Exact
    ) -> list[Demands]:
        """Higher demands on stages that exceed what they may, the others as before.

        Args:
            before: Demands that the solutions were found with.
            solutions: Whose stages are looked at.
            exact: What the motion exceeds when it is played exactly. What no stage
                gives a reason for is demanded of all of them.
        """
        if exact.kept:
            return list(before)
        starts = np.cumsum([len(solution.strokes) for solution in solutions])
        looks = [
            self._looked_at(solution, k)
            for solution in solutions
            for k in range(len(solution.strokes))
        ]
        over = np.array([max(1.0, width) for width, _ in looks])
        shares = np.ones(len(looks))
        if exact.excess > 1.0:
            over *= max(1.0, exact.excess / over.max())
            shares = 1.0 / np.where(over > 1.0, over + SAFE, 1.0)
        own = np.array([lacks for _, lacks in looks])
        lacks = own + np.maximum(exact.lacks - own.max(axis=0), 0.0)
        lacks = np.where(exact.lacks > 0.0, lacks, 0.0)
        parts = np.split(shares, starts[:-1]), np.split(lacks, starts[:-1])
        return [
            demands.raised(share, lack)
            for demands, share, lack in zip(before, *parts, strict=True)
        ]

    def _looked_at(self, solution: Solution, number: int) -> tuple[float, Array]:
        """Largest width and lacks within a stage."""
        stage = self.task.stage(solution.first + number)
        if stage not in self._known:
            self._known[stage] = self._function(stage, solution.states[0])
        moved, amounts = self.task.moved, solution.recoveries[number]
        padded = np.pad(amounts, (0, self.task.widest - len(amounts)))
        begin, places = solution.states[number][moved], solution.places
        ends = float(places[number]), float(places[number + 1])
        given = [begin, solution.strokes[number], padded, *ends]
        found = self._known[stage].call(given)
        width, *lacks = (float(np.array(value).max(initial=0.0)) for value in found)
        return width, np.array(lacks)

    def _function(self, stage: Stage, start: Array) -> Any:
        """Widths and lacks at many steps, from what `_looked_at` gives."""
        ca, task, n = solver(), self.task, len(self.task.moved)
        x, d, a = ca.MX.sym("x", n), ca.MX.sym("d"), ca.MX.sym("a", task.widest)
        s, e, y = ca.MX.sym("s"), ca.MX.sym("e"), ca.SX.sym("y", n)
        moved = stage_function(task, stage, start, FINE)
        steps = moved(x, d, a)
        where = s + (e - s) * ca.DM(np.arange(1, FINE + 1) / FINE).T
        along = following(task, self.path)
        found = along.function.map(FINE)(steps, where, ca.DM.zeros(1, FINE))
        widths = [found[i, :] ** (1 / p) for i, p in enumerate(along.powers)]
        halfway = x if task.together else moved(x, 0.0, a / 2)[:, -1]
        every = ca.horzcat(x, halfway, steps)
        whole = whole_state(task, start, y)
        lacks = []
        for inequality in task.inequalities:
            rows = ca.vertcat(ca.SX(0.0), *inequality.expressions(stage, whole))
            function = ca.Function("rows", [y], [rows])
            lacks.append(-function.map(every.shape[1])(every))
        return ca.Function(
            "stage", [x, d, a, s, e], [ca.vertcat(0, *map(ca.vec, widths)), *lacks]
        )
