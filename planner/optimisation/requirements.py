"""The constraints on the unknowns of a program, collected row by row."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.dynamics import curve_function
from planner.optimisation.solver import solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task
from planner.planning.paths import Path

TINY = 1e-12  # keeps apart from zero what is divided by


class Requirements:
    """Rows with their lowest and highest values."""

    def __init__(self) -> None:
        self.rows: list[Any] = []
        self._bounds: list[Array] = []

    def add(self, rows: Any, low: float, high: float) -> None:
        """Ask for rows between two values."""
        flat = solver().vec(rows)
        self.rows.append(flat)
        self._bounds.append(np.tile([[low], [high]], flat.numel()))

    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest values of all rows."""
        low, high = np.concatenate(self._bounds, axis=1)
        return low, high

    def corridor(
        self,
        task: Task,
        path: Path,
        states: Sequence[Any],
        places: Sequence[Any],
        width: Any,
    ) -> None:
        """Keep states within the tolerances of the path's points that go along.

        The corridor is so many tolerances wide. What is not position is compared where
        the position is nearest: along the path's tangent from the point that goes
        along.
        """
        ca = solver()
        x, s = ca.MX.sym("x", len(task.moved)), ca.MX.sym("s")
        curve = curve_function(path, task.moved)
        parts, nearest = list[Any](), s
        wide = ca.MX.sym("wide")
        for number, tolerance in enumerate(task.tolerances):
            index = [
                task.moved.index(i) for i in tolerance.coordinates if i in task.moved
            ]
            if index and np.isfinite(tolerance.most):
                off = (x - curve(nearest))[index] / tolerance.most
                if len(index) == 1:
                    parts += [off - wide, -off - wide]
                else:
                    parts.append(ca.sumsqr(off) - wide**2)
            if index and number == 0:
                along = ca.jacobian(curve(s)[index], s)
                ahead = ca.dot((x - curve(s))[index], along)
                nearest = s + ahead / (ca.sumsqr(along) + TINY)
        if not parts:
            return
        within = ca.Function("within", [x, s, wide], [ca.vertcat(*parts)])
        every, where = ca.horzcat(*states), ca.horzcat(*places)
        everywhere = ca.repmat(width, 1, where.numel())
        self.add(within.map(where.numel())(every, where, everywhere), -np.inf, 0.0)

    def margins(
        self,
        task: Task,
        stage: Stage,
        start: Array,
        states: tuple[Any, Any],
        width: Any,
    ) -> None:
        """Keep the task's margins and rooms as stages begin, have recovered, and end.

        Rooms are kept where strokes begin and end. What they lack is made up for by the
        width of the corridor beyond its least.

        Args:
            task: Whose margins they are.
            stage: The stage.
            start: State that gives the coordinates that no stage moves, shape (n,).
            states: Where stages begin and end.
            width: Of the corridor, in tolerances, beyond the least.
        """
        if not task.margins and not task.rooms:
            return
        ca, n = solver(), len(task.moved)
        begin, end, more = ca.SX.sym("begin", n), ca.SX.sym("end", n), ca.SX.sym("more")
        recovered = {r.coordinate for r in stage.recoveries}
        mixed = [
            end[k] if i in recovered else begin[k] for k, i in enumerate(task.moved)
        ]
        parts, unit = list[Any](), task.unit(start)
        recovered_first = ca.vertcat(*mixed)
        setting_out = begin if task.together else recovered_first
        for state in (begin, recovered_first, end):
            whole = [ca.SX(float(v)) for v in start]
            for k, i in enumerate(task.moved):
                whole[i] = state[k]
            for margin in task.margins:
                parts += [part / unit for part in margin(stage, whole)]
            for room in task.rooms if state is setting_out or state is end else ():
                parts += [part / unit + more for part in room(stage, whole)]
        if not parts:
            return
        function = ca.Function("margins", [begin, end, more], [ca.vertcat(*parts)])
        count = states[0].shape[1]
        mapped = function.map(count)(*states, ca.repmat(width, 1, count))
        self.add(mapped, 0.0, np.inf)

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
