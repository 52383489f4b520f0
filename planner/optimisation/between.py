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
from planner.optimisation.corridor import gaps
from planner.optimisation.dynamics import stage_function, whole_state
from planner.optimisation.requirements import Demands
from planner.optimisation.solver import solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path

FINE = 12  # steps of a stage
POINTS = 1001  # of the path
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


def _blamed(excess: Array) -> Array:
    """Stages that exceed something, or all where none does, along the first axis."""
    blamed: Array = (excess > 0.0) | ~(excess > 0.0).any(axis=0)
    return blamed


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
        over = np.maximum(1.0, self._widths(solutions, [states for states, _ in looks]))
        shares = np.ones(len(looks))
        if exact.excess > 1.0:
            more = max(1.0, exact.excess / over.max())
            shares = np.where(_blamed(over - 1.0), 1.0 / (over * more + SAFE), 1.0)
        own = np.array([lacks for _, lacks in looks])
        more = np.maximum(exact.lacks - own.max(axis=0), 0.0)
        lacks = np.where(_blamed(own) & (exact.lacks > 0.0), own + more, 0.0)
        parts = np.split(shares, starts[:-1]), np.split(lacks, starts[:-1])
        return [
            demands.raised(share, lack)
            for demands, share, lack in zip(before, *parts, strict=True)
        ]

    def _widths(self, solutions: Sequence[Solution], parts: Sequence[Array]) -> Array:
        """Largest deviation over what is allowed, of the states of each stage.

        The position is compared with the places on the path that the solutions know,
        which follow each other in order.
        """
        asked = self.task.tolerances
        groups = [list(tolerance.coordinates) for tolerance in asked]
        points = self.path.at(np.linspace(0.0, 1.0, POINTS))
        states = np.tile(points[0], (sum(map(len, parts)), 1))
        states[:, self.task.moved] = np.vstack(parts)
        found = gaps(states, points, groups)
        share = np.arange(1, FINE + 1) / FINE
        places = [
            s.places[:-1, None] + np.diff(s.places)[:, None] * share for s in solutions
        ]
        apart = states - self.path.at(np.concatenate([p.ravel() for p in places]))
        found[:, 0] = np.linalg.norm(apart[:, groups[0]], axis=1)
        widths = (found / [t.most for t in asked]).max(axis=1)
        return np.array([part.max() for part in np.split(widths, len(parts))])

    def _looked_at(self, solution: Solution, number: int) -> tuple[Array, Array]:
        """States within a stage, shape (FINE, m), and what they lack."""
        stage = self.task.stage(solution.first + number)
        if stage not in self._known:
            self._known[stage] = self._function(stage, solution.states[0])
        amounts = solution.recoveries[number]
        padded = np.pad(amounts, (0, self.task.widest - len(amounts)))
        begin = solution.states[number][self.task.moved]
        states, *lacks = self._known[stage].call(
            [begin, solution.strokes[number], padded]
        )
        return np.array(states).T, np.array([np.array(lack).max() for lack in lacks])

    def _function(self, stage: Stage, start: Array) -> Any:
        """States and lacks at many steps, from start, stroke and recoveries."""
        ca, task, n = solver(), self.task, len(self.task.moved)
        x, d, a = ca.MX.sym("x", n), ca.MX.sym("d"), ca.MX.sym("a", task.widest)
        y, lacks = ca.SX.sym("y", n), list[Any]()
        moved = stage_function(task, stage, start, FINE)
        steps = moved(x, d, a)
        halfway = x if task.together else moved(x, 0.0, a / 2)[:, -1]
        every = ca.horzcat(x, halfway, steps)
        whole = whole_state(task, start, y)
        for inequality in task.inequalities:
            rows = ca.vertcat(ca.SX(0.0), *inequality.expressions(stage, whole))
            function = ca.Function("rows", [y], [rows])
            lacks.append(-function.map(every.shape[1])(every))
        return ca.Function("between", [x, d, a], [steps, *lacks])
