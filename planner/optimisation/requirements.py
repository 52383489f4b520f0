"""The constraints on the unknowns of a program, collected row by row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.dynamics import Following, whole_state
from planner.optimisation.solver import solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task

TIGHTER = 0.98  # part of the tolerances kept at the steps, for what lies in between

Narrowed = Callable[["Demands"], Array]


@dataclass(frozen=True, eq=False)
class Demands:
    """What is asked of each stage in addition, for the motion between its checks.

    Attributes:
        shares: Part of its tolerances that a stage keeps, shape (count,).
        lacks: What each of the task's inequalities exceeds zero by, shape (count, R).
    """

    shares: Array
    lacks: Array

    @classmethod
    def none(cls, task: Task, count: int) -> Demands:
        """Nothing in addition."""
        return cls(np.ones(count), np.zeros((count, len(task.inequalities))))

    @classmethod
    def joined(cls, parts: Sequence[Demands]) -> Demands:
        """Demands on the stages of several solutions as one.

        Args:
            parts: In the order of the solutions.
        """
        shares = np.concatenate([part.shares for part in parts])
        return cls(shares, np.vstack([part.lacks for part in parts]))

    def raised(self, shares: Array, lacks: Array) -> Demands:
        """Higher demands; the same if nothing is asked for.

        Args:
            shares: Part of what was kept so far, shape (count,).
            lacks: What is asked for in addition, shape (count, R).
        """
        if (shares == 1.0).all() and (lacks == 0.0).all():
            return self
        return Demands(self.shares * shares, self.lacks + lacks)


class Requirements:
    """Rows with their lowest and highest values."""

    def __init__(self) -> None:
        self.rows: list[Any] = []
        self._bounds: list[Array] = []
        self._narrowed: list[tuple[slice, Narrowed]] = []

    def add(
        self, rows: Any, low: float, high: float, narrowed: Narrowed | None = None
    ) -> None:
        """Ask for rows between two values.

        Args:
            rows: A matrix of expressions.
            low: Lowest value.
            high: Highest value.
            narrowed: What demands make the range of each row narrower by at its ends,
                of the shape of the rows.
        """
        flat = solver().vec(rows)
        self.rows.append(flat)
        first = sum(bounds.shape[1] for bounds in self._bounds)
        self._bounds.append(np.tile([[low], [high]], flat.numel()))
        if narrowed is not None:
            self._narrowed.append((slice(first, first + flat.numel()), narrowed))

    def bounds(self, demands: Demands | None = None) -> tuple[Array, Array]:
        """Lowest and highest values of all rows."""
        low, high = np.concatenate(self._bounds, axis=1)
        if demands is None:
            return low, high
        for rows, narrowed in self._narrowed:
            amount = narrowed(demands).ravel(order="F")
            low[rows] += amount
            high[rows] -= amount
        return low, high

    def corridor(
        self,
        following: Following,
        states: Sequence[Any],
        places: Sequence[Any],
        widths: Sequence[Any],
        stages: Array,
    ) -> None:
        """Keep states within the tolerances of the path's points that go along.

        Args:
            following: The path and its tolerances.
            states: Columns of states.
            places: Where on the path the points are.
            widths: Of the corridor there, in tolerances.
            stages: Number of each column's stage; one that is fixed has none, -1.
        """
        if not following.powers:
            return
        ca = solver()
        every, where = ca.horzcat(*states), ca.horzcat(*places)
        wide = ca.horzcat(*widths)
        rows = following.function.map(where.numel())(every, where, wide)
        powers = np.array(following.powers)[:, None]

        def narrowed(demands: Demands) -> Array:
            shares = np.where(stages < 0, 1.0, demands.shares[stages])
            amounts: Array = TIGHTER**powers * (1.0 - shares**powers)
            return amounts

        self.add(rows, -np.inf, 0.0, narrowed)

    def inequalities(
        self,
        task: Task,
        stage: Stage,
        start: Array,
        states: tuple[Any, Any],
        width: Any,
        stages: Sequence[int],
    ) -> None:
        """Keep the task's inequalities as stages begin, have recovered, and end.

        What those that may be violated lack is made up for by the width of the corridor
        beyond its least.

        Args:
            task: Whose inequalities they are.
            stage: The stage.
            start: State that gives the coordinates that no stage moves, shape (n,).
            states: Where stages begin and end.
            width: Of the corridor there, in tolerances, beyond the least.
            stages: Numbers of these stages.
        """
        if not task.inequalities:
            return
        ca, n = solver(), len(task.moved)
        begin, end, more = ca.SX.sym("begin", n), ca.SX.sym("end", n), ca.SX.sym("more")
        recovered = {r.coordinate for r in stage.recoveries}
        mixed = [
            end[k] if i in recovered else begin[k] for k, i in enumerate(task.moved)
        ]
        parts, kinds, unit = list[Any](), list[tuple[int, int]](), task.unit(start)
        for place, state in enumerate((begin, ca.vertcat(*mixed), end)):
            whole = whole_state(task, start, state)
            for number, inequality in enumerate(task.inequalities):
                if inequality.relaxed and task.together and place == 1:
                    continue  # recovered only as the stroke ends
                slack = more if inequality.relaxed else 0.0
                found = inequality.expressions(stage, whole)
                parts += [part / unit + slack for part in found]
                kinds += [(place, number)] * len(found)
        if not parts:
            return
        function = ca.Function("inequalities", [begin, end, more], [ca.vertcat(*parts)])
        count = states[0].shape[1]
        mapped = function.map(count)(*states, width)

        def narrowed(demands: Demands) -> Array:
            last = len(demands.shares) - 1
            amounts = demands.lacks[np.ix_(stages, [number for _, number in kinds])].T
            fixed = [
                [(place == 0 and k == 0) or (place == 2 and k == last) for k in stages]
                for place, _ in kinds
            ]
            narrower: Array = np.where(fixed, 0.0, amounts) / unit
            return narrower

        self.add(mapped, 0.0, np.inf, narrowed)

    def times(
        self, task: Task, stages: Sequence[Stage], times: Any, D: Any, A: Any
    ) -> None:
        """The time of a stage is at least that of each of its parts."""
        for k, stage in enumerate(stages):
            if stage.stroke:
                self.add(times[k] - task.cost(stage.stroke) * D[k], 0.0, np.inf)
            for j, recovery in enumerate(stage.recoveries):
                part = task.cost(recovery.field) * A[j, k]
                self.add(times[k] - part, 0.0, np.inf)
