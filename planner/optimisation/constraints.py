"""Constraints of the nonlinear program, and the CasADi functions that they read.

These are the motion within a stage and the distance from the path. Margins tighten the
bounds of constraints where the motion between checked points asks for it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.solver import Expression, casadi_function, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task, built_once
from planner.planning.paths import Path

CHECKED_SHARE = 0.999  # of the tolerances, allowed where they are checked
STAGE_STEPS = 3  # of Runge and Kutta's method; the path is compared after each
STRAIGHT = 1e-9  # deviation from a straight line, relative to the size of the path
TINY = 1e-12  # added to denominators that may be zero


@dataclass(frozen=True, eq=False)
class Margins:
    """Margins for the motion between the points where constraints are checked."""

    shares: Array  # of its tolerances that each stage may use, shape (count,)
    inequalities: Array  # least values of the task's in each stage, shape (count, R)

    @classmethod
    def none(cls, task: Task, count: int) -> "Margins":
        """No margins, for a number of stages."""
        return cls(np.ones(count), np.zeros((count, len(task.inequalities))))

    @classmethod
    def joined(cls, parts: "Sequence[Margins]") -> "Margins":
        """Margins of consecutive solutions, as those of one solution."""
        shares = np.concatenate([part.shares for part in parts])
        return cls(shares, np.vstack([part.inequalities for part in parts]))

    def enlarged(self, shares: Array, inequalities: Array) -> "Margins":
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

        def tightening(margins: Margins) -> Array:
            shares = np.where(stages < 0, 1.0, margins.shares[stages])
            return np.asarray(CHECKED_SHARE**powers * (1.0 - shares**powers))

        self.add(within.map(columns[1].numel())(*columns), -np.inf, 0.0, tightening)

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
        of its minimum, in tolerances. States are those at both ends of all occurrences
        of the stage, as columns; `stages` are their numbers, `start` as elsewhere.
        """
        function, kinds = _inequalities(task, stage, start)
        if not kinds:
            return
        unit = task.unit(start)
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


@built_once
def _inequalities(
    task: Task, stage: Stage, start: Array
) -> tuple[Expression, list[tuple[int, int]]]:
    """The inequalities as a function of a stage's ends and the excess width.

    With it the place, 0 to 2, and the number of the inequality in the task, row by row.
    """
    ca, n = solver(), len(task.moved)
    begin, end = ca.SX.sym("begin", n), ca.SX.sym("end", n)
    excess = ca.SX.sym("excess")
    recovered = {r.coordinate for r in stage.recoveries}
    mixed = [end[k] if i in recovered else begin[k] for k, i in enumerate(task.moved)]
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
    every = ca.vertcat(*parts)
    return ca.Function("inequalities", [begin, end, excess], [every]), kinds


def path_distance(task: Task, path: Path) -> tuple[Expression, list[int]]:
    """The distance from a path, in the groups of coordinates that have tolerances.

    The function maps the unknown coordinates, the place on the path and the width of
    the corridor to values at most zero inside, each with the width to a power. The
    first group is the position, compared at the place; the others are compared where
    the tangent there is nearest to the position.
    """
    ca = solver()
    x, s = ca.MX.sym("x", len(task.moved)), ca.MX.sym("s")
    curve, _ = curve_function(path, task.moved)
    parts, powers, nearest = list[Expression](), list[int](), s
    wide = ca.MX.sym("wide")
    for number, tolerance in enumerate(task.tolerances):
        index = [task.moved.index(i) for i in tolerance.coordinates if i in task.moved]
        if index and np.isfinite(tolerance.most):
            off = (x - curve(nearest))[index] / tolerance.most
            if len(index) == 1:
                parts += [off - wide, -off - wide]
                powers += [1, 1]
            else:
                parts.append(ca.sumsqr(off) - wide**2)
                powers.append(2)
        if index and number == 0:
            along = ca.jacobian(curve(s)[index], s)
            ahead = ca.dot((x - curve(s))[index], along)
            nearest = s + ahead / (ca.sumsqr(along) + TINY)
    return ca.Function("within", [x, s, wide], [ca.vertcat(*parts)]), powers


def whole_state(task: Task, start: Array, moved: Expression) -> list[Expression]:
    """All entries of a state: the unknown ones, and the others from a given state."""
    whole = [solver().SX(float(v)) for v in start]
    for k, i in enumerate(task.moved):
        whole[i] = moved[k]
    return whole


@built_once
def stage_function(
    task: Task, stage: Stage, start: Array, count: int = STAGE_STEPS
) -> Expression:
    """The states after each step of a stage, from its start, stroke and recoveries.

    Integrates by the classical Runge-Kutta method. Recoveries precede the stroke, or
    take place during it. `start`, shape (n,), has the coordinates that no stage moves.
    """
    ca, n = solver(), len(task.moved)
    x, d = ca.SX.sym("x", n), ca.SX.sym("d")
    a = ca.SX.sym("a", task.most_recoveries)
    recovered = ca.SX.zeros(n)
    for j, recovery in enumerate(() if task.centred else stage.recoveries):
        recovered[task.moved.index(recovery.coordinate)] += recovery.rate * a[j]
    state, during = (x, recovered) if task.overlapped else (x + recovered, 0.0)
    stroke, h, steps = _stroke(task, stage, start), 1.0 / count, []

    def rate(y: Expression, u: float) -> Expression:
        return stroke(y, d, u * h) * d + during

    for step in range(count):
        k1 = rate(state, step)
        k2 = rate(state + h / 2 * k1, step + 0.5)
        k3 = rate(state + h / 2 * k2, step + 0.5)
        k4 = rate(state + h * k3, step + 1.0)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        steps.append(state)
    return ca.Function("stage", [x, d, a], [ca.horzcat(*steps)])


def curve_function(
    path: Path, moved: list[int]
) -> tuple[Callable[[Expression], Expression], bool]:
    """Some coordinates of a path as functions of s: linear, or else splines; which."""
    ca, grid = solver(), np.linspace(0.0, 1.0, 200)  # knots of a spline
    values = path.at(grid)[:, moved]
    begin, way = values[0], values[-1] - values[0]
    off = values - begin - grid[:, None] * way
    if np.abs(off).max() <= STRAIGHT * (1.0 + np.abs(values).max()):
        return lambda s: ca.DM(begin) + ca.DM(way) * s, True
    return ca.interpolant("path", "bspline", [grid], values.ravel()), False


def _stroke(
    task: Task, stage: Stage, start: Array
) -> Callable[[Expression, Expression, float], Expression]:
    """Velocity along a stage's stroke, from state, amount and the share that is done.

    Coordinates that are repositioned before the stroke are centred on zero in it.
    """
    ca, system = solver(), task.system
    if not stage.stroke:
        return lambda x, d, u: ca.SX.zeros(len(task.moved))
    velocity = casadi_function(system.state, tuple(system.fields[stage.stroke]))
    centred = {i: rate for i, rate in task.rates(stage).items() if i not in task.moved}

    def along(x: Expression, d: Expression, u: float) -> Expression:
        whole = whole_state(task, start, x)
        for i, rate in centred.items():
            whole[i] = (u - 0.5) * d * rate
        rates = velocity(whole)
        return ca.vertcat(*(rates[i] for i in task.moved))

    return along
