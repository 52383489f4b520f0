"""Stages and paths as CasADi functions, which are differentiated exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.solver import casadi_function, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Task
from planner.planning.paths import Path

STEPS = 3  # of a stage, where it is integrated and compared with the path
KNOTS = 200  # of the spline that stands for a path that is not straight
STRAIGHT = 1e-9  # of a path's size, that a straight one may be off by
TINY = 1e-12  # keeps apart from zero what is divided by


@dataclass(frozen=True)
class Following:
    """How far a state is from the point of a path that goes along with it.

    Attributes:
        function: Of the unknown coordinates, the place on the path and the width of
            the corridor in tolerances; its values are at most zero inside.
        powers: Of the width, in each of the values; empty if nothing is compared.
    """

    function: Any
    powers: tuple[int, ...]


def following(task: Task, path: Path) -> Following:
    """How closely a task wants a path to be followed.

    What is not position is compared where the position is nearest: along the path's
    tangent from the point that goes along.

    Args:
        task: What is optimised.
        path: Configurations to follow.
    """
    ca = solver()
    x, s = ca.MX.sym("x", len(task.moved)), ca.MX.sym("s")
    curve = curve_function(path, task.moved)
    parts, powers, nearest = list[Any](), list[int](), s
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
    function = ca.Function("within", [x, s, wide], [ca.vertcat(*parts)])
    return Following(function, tuple(powers))


def whole_state(task: Task, start: Array, moved: Any) -> list[Any]:
    """All entries of a state, from those that are unknown.

    Args:
        task: What is optimised.
        start: State that gives the coordinates that no stage moves, shape (n,).
        moved: The unknown coordinates.
    """
    whole = [solver().SX(float(v)) for v in start]
    for k, i in enumerate(task.moved):
        whole[i] = moved[k]
    return whole


def stage_function(task: Task, stage: Stage, start: Array, count: int = STEPS) -> Any:
    """The states of a stage's steps, from its start, stroke and recoveries.

    Runge and Kutta's classical method; recoveries come first, or during the stroke.

    Args:
        task: What is optimised.
        stage: The stage.
        start: State that gives the coordinates that no stage moves, shape (n,).
        count: Number of steps.
    """
    ca, n = solver(), len(task.moved)
    x, d = ca.SX.sym("x", n), ca.SX.sym("d")
    a = ca.SX.sym("a", task.widest)
    recovered = _recovered(task, stage, a)
    state, during = (x, recovered) if task.together else (x + recovered, 0.0)
    stroke, h, steps = _stroke(task, stage, start), 1.0 / count, []

    def rate(y: Any, u: float) -> Any:
        return stroke(y, d, u * h) * d + during

    for step in range(count):
        k1 = rate(state, step)
        k2 = rate(state + h / 2 * k1, step + 0.5)
        k3 = rate(state + h / 2 * k2, step + 0.5)
        k4 = rate(state + h * k3, step + 1.0)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        steps.append(state)
    return ca.Function("stage", [x, d, a], [ca.horzcat(*steps)])


def curve_function(path: Path, moved: list[int]) -> Callable[[Any], Any]:
    """A path as a function of s.

    Args:
        path: Configurations.
        moved: Coordinates to give.
    """
    ca = solver()
    grid = np.linspace(0.0, 1.0, KNOTS)
    values = path.at(grid)[:, moved]
    begin, way = values[0], values[-1] - values[0]
    off = np.abs(values - begin - grid[:, None] * way).max()
    if off <= STRAIGHT * (1.0 + np.abs(values).max()):
        return lambda s: ca.DM(begin) + ca.DM(way) * s
    spline = ca.interpolant("path", "bspline", [grid], values.ravel())
    return lambda s: spline(s)


def _recovered(task: Task, stage: Stage, amounts: Any) -> Any:
    """Change of the unknown coordinates by a stage's recoveries."""
    ca = solver()
    change = ca.SX.zeros(len(task.moved))
    for j, recovery in enumerate(() if task.centred else stage.recoveries):
        k = task.moved.index(recovery.coordinate)
        change[k] += recovery.rate * amounts[j]
    return change


def _stroke(task: Task, stage: Stage, start: Array) -> Callable[[Any, Any, float], Any]:
    """Velocity of a stage's stroke, from state, amount and how much of it is done."""
    ca, system = solver(), task.system
    if not stage.stroke:
        return lambda x, d, u: ca.SX.zeros(len(task.moved))
    velocity = casadi_function(system.state, list(system.fields[stage.stroke]))
    set_anew = {i: rate for i, rate in task.rates(stage).items() if i not in task.moved}

    def along(x: Any, d: Any, u: float) -> Any:
        whole = whole_state(task, start, x)
        for i, rate in set_anew.items():
            whole[i] = (u - 0.5) * d * rate
        rates = velocity(whole)
        return ca.vertcat(*(rates[i] for i in task.moved))

    return along
