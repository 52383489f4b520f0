"""Other planners on a problem: CasADi with IPOPT, and the samplers of OMPL.

The controls are the fields that the problem's elements are made of, as they act on the
bottom stratum, one at a time. A plan is a sequence of such fields with signed
durations, and its cost is the sum of their absolute values, the travel. Each planner
is one function from a task to a plan; where its library is missing it raises
`ImportError`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from models import Problem
from planner import Array, extend
from planner.systems import flow_map, rates_with

Stroke = tuple[str, float]  # name of a field, signed duration
STEPS = 8  # of Runge and Kutta's method for a stroke of IPOPT's
GUESSES = 40
GOAL_MET = 1e-6  # share of the unit of length
UNUSED = 1e-6  # duration below which the interior point leaves what it does not need
SAMPLING_TIME = 3.0  # [s] of OMPL
GOAL_REGION = 0.1  # share of the distance from start to goal, where sampling ends
SAMPLING_STEP = 0.05  # likewise, of which sampled strokes are multiples
LONGEST_STROKE = 40  # of these steps
SEED = 1  # time still decides how far samplers get


@dataclass(frozen=True, eq=False)
class Task:
    """A problem, and what its coordinates are measured in."""

    problem: Problem
    units: tuple[float, ...] = ()  # size of a typical motion along each; ones if empty
    rounds: int = 6  # how often IPOPT may use every field

    @cached_property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields that are the controls."""
        problem = self.problem
        return extend(problem.system, problem.elements).steering.hall.generators

    @cached_property
    def scale(self) -> Array:
        """Units of the coordinates, shape (n,)."""
        return np.array(self.units or np.ones_like(self.problem.states[0]))

    def end(self, strokes: Iterable[Stroke]) -> Array:
        """Where strokes lead from the start, exactly, shape (n,)."""
        x = self.problem.states[0]
        for name, duration in strokes:
            x = flow_map(self.problem.system, name, x, duration)
        return x

    def error(self, strokes: Iterable[Stroke]) -> float:
        """Distance of the end from the goal, in the unit of the first coordinate."""
        missed = (self.end(strokes) - self.problem.states[1]) / self.scale
        return float(np.linalg.norm(missed) * self.scale[0])


def travel(strokes: Iterable[Stroke]) -> float:
    """Sum of the absolute durations."""
    return sum(abs(duration) for _, duration in strokes)


def joined(strokes: Iterable[Stroke]) -> list[Stroke]:
    """Successive strokes of one field joined; those that cancel disappear."""
    left: list[Stroke] = []
    for name, duration in strokes:
        if left and left[-1][0] == name:
            duration += left.pop()[1]
        if duration:
            left.append((name, duration))
    return left


class MultipleShooting:
    """The least travel as a nonlinear program for IPOPT, compiled.

    States between strokes are unknowns like the durations, so that a poor first guess
    does not distort the whole path.
    """

    def __init__(self, task: Task) -> None:
        import casadi

        self._task = task
        self._names = task.fields * task.rounds
        start, goal = task.problem.states
        count = len(self._names)
        forward, back = (casadi.SX.sym(name, count) for name in ("forward", "back"))
        states = casadi.SX.sym("states", len(start), count)
        flows = {name: _flow(task.problem, name, casadi) for name in task.fields}
        before: Any = casadi.DM(start)
        gaps = [states[:, -1] - casadi.DM(goal)]
        for k, name in enumerate(self._names):
            after = flows[name](before, [], forward[k] - back[k])
            before = states[:, k]
            gaps.append(after - before)
        program = {
            "x": casadi.vertcat(forward, back, casadi.vec(states)),
            "f": casadi.sum1(forward + back),
            "g": casadi.vertcat(*gaps),
        }
        quiet: Any = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False}
        self._solver = casadi.nlpsol("shooting", "ipopt", program, quiet)
        free = np.full(len(start) * count, -np.inf)
        self._lowest = np.concatenate([np.zeros(2 * count), free])

    def once(self, durations: Array | None = None) -> list[Stroke]:
        """Strokes found from one guess, by default a tenth each."""
        count = len(self._names)
        guess = np.full(count, 0.1) if durations is None else durations
        strokes = list(zip(self._names, guess.tolist(), strict=True))
        states = [self._task.end(strokes[: k + 1]) for k in range(count)]
        unknowns = [np.maximum(guess, 0), np.maximum(-guess, 0), np.ravel(states)]
        found = self._solver(
            x0=np.concatenate(unknowns), lbx=self._lowest, lbg=0, ubg=0
        )
        forward, back = np.array(found["x"])[: 2 * count, 0].reshape(2, count)
        pairs = zip(self._names, (forward - back).tolist(), strict=True)
        return joined(pair for pair in pairs if abs(pair[1]) > UNUSED)

    def best(self) -> list[Stroke]:
        """The strokes of least travel that were found from many guesses."""
        rng = np.random.default_rng(0)
        found = [self.once(rng.normal(size=len(self._names))) for _ in range(GUESSES)]
        near = GOAL_MET * self._task.scale[0]
        return min((s for s in found if self._task.error(s) < near), key=travel)


def _flow(problem: Problem, name: str, casadi: Any) -> Any:
    """The state after a field is followed, by Runge and Kutta's method, in symbols."""
    functions = {word: getattr(casadi, word) for word in ("sin", "cos", "tan")}
    field, state = problem.system.fields[name], problem.system.state
    x, none = casadi.SX.sym("x", len(state)), casadi.SX.sym("none", 0)
    rates = rates_with(field, state, functions)(*casadi.vertsplit(x))
    motion = casadi.Function("motion", [x, none], [casadi.vertcat(*rates)])
    return casadi.simpleRK(motion, STEPS)


def sampled(
    task: Task, planner: str = "RRT", seconds: float = SAMPLING_TIME
) -> list[Stroke]:
    """Strokes that a kinematic planner of OMPL finds in time, near the goal or not.

    The propagator is called from C++ in Python, so that these planners see far fewer
    samples in a second than they would natively.
    """
    from ompl import base, control, util

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(SEED)
    start, goal = (values / task.scale for values in task.problem.states)
    way, size = float(np.linalg.norm(goal - start)), len(start)
    room = 3 * max(1.0, float(np.abs(goal - start).max()))
    space = base.RealVectorStateSpace(size)
    space.setBounds(-room, room)
    count = len(task.fields)
    choices = control.RealVectorControlSpace(space, 1)
    bounds = base.RealVectorBounds(1)
    bounds.setLow(-float(count))
    bounds.setHigh(float(count))
    choices.setBounds(bounds)
    setup = control.SimpleSetup(choices)
    setup.setStateValidityChecker(lambda state: space.satisfiesBounds(state))
    system = task.problem.system
    rates = {name: system.compiled(name).velocity for name in task.fields}

    def stroke(chosen: Any, duration: float) -> Stroke:
        """The sign of the control is the stroke's, its size says which field."""
        name = task.fields[min(int(abs(chosen[0])), count - 1)]
        return name, math.copysign(duration, chosen[0])

    def set_to(state: Any, values: Array) -> Any:
        for i, value in enumerate(values.tolist()):
            state[i] = value
        return state

    def propagate(state: Any, chosen: Any, duration: float, result: Any) -> None:
        x = np.array([state[i] for i in range(size)]) * task.scale
        name, h = stroke(chosen, duration)
        set_to(result, (x + h * rates[name](x + h / 2 * rates[name](x))) / task.scale)

    setup.setStatePropagator(propagate)
    ends = (set_to(space.allocState(), values) for values in (start, goal))
    setup.setStartAndGoalStates(*ends, GOAL_REGION * way)
    information = setup.getSpaceInformation()
    speeds = [np.abs(rates[name](start * task.scale) / task.scale) for name in rates]
    information.setPropagationStepSize(SAMPLING_STEP * way / float(np.max(speeds)))
    information.setMinMaxControlDuration(1, LONGEST_STROKE)
    setup.setPlanner(getattr(control, planner)(information))
    setup.solve(seconds)
    path = setup.getSolutionPath()
    runs = zip(path.getControls(), path.getControlDurations(), strict=True)
    return [stroke(chosen, duration) for chosen, duration in runs]


def reeds_shepp(goal: Sequence[float], radius: float) -> float:
    """Length of the shortest path of arcs and straight pieces to x, y and yaw [rad]."""
    from ompl import base

    space = base.ReedsSheppStateSpace(radius)
    ends = [space.allocState(), space.allocState()]
    for state, (x, y, yaw) in zip(ends, ((0.0, 0.0, 0.0), goal), strict=True):
        state.setXY(x, y)
        state.setYaw(yaw)
    return float(space.distance(*ends))
