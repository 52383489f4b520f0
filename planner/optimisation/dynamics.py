"""Motion within a stage, and distance from a path, as CasADi functions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.solver import Expression, casadi_function, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task
from planner.planning.paths import Path

STAGE_STEPS = 3  # of Runge and Kutta's method; the path is compared after each
SPLINE_KNOTS = 200  # of the spline that stands for a path that is not straight
STRAIGHT = 1e-9  # deviation from a straight line, relative to the size of the path
TINY = 1e-12  # added to denominators that may be zero


def path_distance(task: Task, path: Path) -> tuple[Expression, list[int]]:
    """The distance from a path, in the groups of coordinates that have tolerances.

    The function maps the unknown coordinates, the place on the path and the width of
    the corridor in tolerances to values that are at most zero inside; each value has
    the width to a power. The first group is the position, compared at the place; the
    others are compared where the tangent there is nearest to the position.
    """
    ca = solver()
    x, s = ca.MX.sym("x", len(task.moved)), ca.MX.sym("s")
    curve = curve_function(path, task.moved)
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


def curve_function(path: Path, moved: list[int]) -> Callable[[Expression], Expression]:
    """Some coordinates of a path as a function of s, linear or a spline."""
    ca = solver()
    grid = np.linspace(0.0, 1.0, SPLINE_KNOTS)
    values = path.at(grid)[:, moved]
    if is_straight(path, moved):
        begin, way = values[0], values[-1] - values[0]
        return lambda s: ca.DM(begin) + ca.DM(way) * s
    spline = ca.interpolant("path", "bspline", [grid], values.ravel())
    return lambda s: spline(s)


def is_straight(path: Path, moved: list[int]) -> bool:
    """Whether some coordinates of a path are linear in s."""
    grid = np.linspace(0.0, 1.0, SPLINE_KNOTS)
    values = path.at(grid)[:, moved]
    off = values - values[0] - grid[:, None] * (values[-1] - values[0])
    return bool(np.abs(off).max() <= STRAIGHT * (1.0 + np.abs(values).max()))


def _stroke(
    task: Task, stage: Stage, start: Array
) -> Callable[[Expression, Expression, float], Expression]:
    """Velocity along a stage's stroke, from state, amount and the share that is done.

    Coordinates that are repositioned before the stroke are centred on zero in it.
    """
    ca, system = solver(), task.system
    if not stage.stroke:
        return lambda x, d, u: ca.SX.zeros(len(task.moved))
    velocity = casadi_function(system.state, list(system.fields[stage.stroke]))
    centred = {i: rate for i, rate in task.rates(stage).items() if i not in task.moved}

    def along(x: Expression, d: Expression, u: float) -> Expression:
        whole = whole_state(task, start, x)
        for i, rate in centred.items():
            whole[i] = (u - 0.5) * d * rate
        rates = velocity(whole)
        return ca.vertcat(*(rates[i] for i in task.moved))

    return along
