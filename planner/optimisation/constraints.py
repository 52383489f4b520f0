"""Constraints of the nonlinear program, their bounds, and margins that tighten them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.dynamics import whole_state
from planner.optimisation.solver import Expression, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task

CHECKED_SHARE = 0.999  # of the tolerances, allowed where they are checked


@dataclass(frozen=True, eq=False)
class Margins:
    """Margins for the motion between the points where constraints are checked."""

    shares: Array  # of its tolerances that each stage may use, shape (count,)
    inequalities: Array  # least values of the task's in each stage, shape (count, R)

    @classmethod
    def none(cls, task: Task, count: int) -> Margins:
        """No margins, for a number of stages."""
        return cls(np.ones(count), np.zeros((count, len(task.inequalities))))

    @classmethod
    def joined(cls, parts: Sequence[Margins]) -> Margins:
        """Margins of consecutive solutions, as those of one solution."""
        shares = np.concatenate([part.shares for part in parts])
        return cls(shares, np.vstack([part.inequalities for part in parts]))

    def enlarged(self, shares: Array, inequalities: Array) -> Margins:
        """Margins with smaller shares, shape (count,), and higher bounds (count, R).

        Margins that do not change are the same object.
        """
        if (shares == 1.0).all() and (inequalities == 0.0).all():
            return self
        return Margins(self.shares * shares, self.inequalities + inequalities)


Tightening = Callable[[Margins], Array]


class Constraints:
    """Constraints g(x) with lower and upper bounds, collected row by row."""

    def __init__(self) -> None:
        self.rows: list[Expression] = []
        self._bounds: list[tuple[Array, Tightening | None]] = []

    def add(
        self,
        rows: Expression,
        low: float,
        high: float,
        tightening: Tightening | None = None,
    ) -> None:
        """Add constraints low <= rows <= high for a matrix of expressions.

        Tightening maps margins to amounts of that shape, by which both bounds tighten.
        """
        flat = solver().vec(rows)
        self.rows.append(flat)
        self._bounds.append((np.tile([[low], [high]], flat.numel()), tightening))

    def bounds(self, margins: Margins | None = None) -> tuple[Array, Array]:
        """Lower and upper bounds of all rows, tightened by margins."""
        parts = []
        for bounds, tightening in self._bounds:
            if margins and tightening:
                amount = tightening(margins).ravel(order="F")
                bounds = bounds + [amount, -amount]
            parts.append(bounds)
        low, high = np.concatenate(parts, axis=1)
        return low, high

    def corridor(
        self,
        distance: tuple[Expression, Sequence[int]],
        states: Sequence[Expression],
        places: Sequence[Expression],
        widths: Sequence[Expression],
        stages: Array,
    ) -> None:
        """Keep states, as columns, within the tolerances of points of the path.

        A place on the path, a width of the corridor in tolerances and the number of a
        stage belong to each state; the number is -1 for a state that is fixed, to which
        margins do not apply. The distance is as `path_distance` gives it.
        """
        within, powers = distance[0], np.array(distance[1])[:, None]
        if not powers.size:
            return
        columns = [solver().horzcat(*parts) for parts in (states, places, widths)]
        rows = within.map(columns[1].numel())(*columns)

        def tightening(margins: Margins) -> Array:
            shares = np.where(stages < 0, 1.0, margins.shares[stages])
            return np.asarray(CHECKED_SHARE**powers * (1.0 - shares**powers))

        self.add(rows, -np.inf, 0.0, tightening)

    def inequalities(
        self,
        task: Task,
        stage: Stage,
        start: Array,
        states: tuple[Expression, Expression],
        width: Expression,
        stages: Sequence[int],
    ) -> None:
        """Impose the task's inequalities where stages begin, have recovered and end.

        Soft constraints share one slack variable with the corridor: its width in excess
        of its minimum, in tolerances. States are those at the beginnings and ends of
        all occurrences of the stage, as columns, and `stages` are their numbers;
        `start`, shape (n,), has the coordinates that no stage moves.
        """
        if not task.inequalities:
            return
        ca, n = solver(), len(task.moved)
        begin, end = ca.SX.sym("begin", n), ca.SX.sym("end", n)
        excess = ca.SX.sym("excess")
        recovered = {r.coordinate for r in stage.recoveries}
        mixed = [
            end[k] if i in recovered else begin[k] for k, i in enumerate(task.moved)
        ]
        parts, kinds = list[Expression](), list[tuple[int, int]]()
        unit = task.unit(start)
        for place, state in enumerate((begin, ca.vertcat(*mixed), end)):
            whole = whole_state(task, start, state)
            for number, inequality in enumerate(task.inequalities):
                if inequality.relaxed and task.overlapped and place == 1:
                    continue  # recovered only as the stroke ends
                slack = excess if inequality.relaxed else 0.0
                found = inequality.expressions(stage, whole)
                parts += [part / unit + slack for part in found]
                kinds += [(place, number)] * len(found)
        if not parts:
            return
        arguments = [begin, end, excess]
        function = ca.Function("inequalities", arguments, [ca.vertcat(*parts)])
        mapped = function.map(states[0].shape[1])(*states, width)

        def tightening(margins: Margins) -> Array:
            last = len(margins.shares) - 1
            places, numbers = zip(*kinds, strict=True)
            amounts = margins.inequalities[np.ix_(stages, numbers)].T
            ends = (0, 0), (2, last)  # of which state, in which stage
            fixed = [[(place, k) in ends for k in stages] for place in places]
            return np.asarray(np.where(fixed, 0.0, amounts) / unit)

        self.add(mapped, 0.0, np.inf, tightening)

    def durations(
        self,
        task: Task,
        stages: Sequence[Stage],
        times: Expression,
        strokes: Expression,
        recoveries: Expression,
    ) -> None:
        """Bound the duration of each stage below by those of its parts."""
        for k, stage in enumerate(stages):
            if stage.stroke:
                self.add(times[k] - task.cost(stage.stroke) * strokes[k], 0.0, np.inf)
            for j, recovery in enumerate(stage.recoveries):
                part = task.cost(recovery.field) * recoveries[j, k]
                self.add(times[k] - part, 0.0, np.inf)
