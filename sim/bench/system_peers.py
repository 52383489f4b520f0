"""CasADi and OMPL on shipped systems, with the fields as controls, one at a time.

The fields are those that the elements are made of, as they act on the bottom stratum.
This needs the extra `peers`; without it the cells of the table say so.
"""

from __future__ import annotations

import time
from importlib.util import find_spec
from typing import Any

import numpy as np

from models import Problem
from planner import Array, extend, flow_map
from planner.systems import rates_with

ROUNDS = 6  # in which every field is on once
STEPS = 4  # of Runge and Kutta's method for a flow
PATIENCE = 3.0  # [s] of OMPL
SEED = 1
ABSENT = "not installed"


def generators(problem: Problem) -> tuple[str, ...]:
    """Names of the fields that the problem's elements are made of.

    Args:
        problem: System and goal.
    """
    return extend(problem.system, problem.elements).steering.hall.generators


def end_of(problem: Problem, durations: Array) -> Array:
    """Where rounds of single fields end, exactly.

    Args:
        problem: System and start.
        durations: Signed durations of the fields in turn, shape (flows,).
    """
    names = generators(problem)
    x = problem.states[0]
    for i, duration in enumerate(durations):
        x = flow_map(problem.system, names[i % len(names)], x, float(duration))
    return x


def casadi_cell(problem: Problem) -> str:
    """Flows, distance and time of IPOPT on the durations, from one guess.

    Args:
        problem: What to reach.
    """
    if find_spec("casadi") is None:
        return ABSENT
    import casadi

    names = generators(problem)
    count = ROUNDS * len(names)
    durations = casadi.SX.sym("t", count)
    fields = [_casadi_field(problem, name, casadi) for name in names]
    start, goal = problem.states
    x: Any = casadi.DM(start)
    for i in range(count):
        field, h = fields[i % len(names)], durations[i] / STEPS
        for _ in range(STEPS):
            a = field(x)
            b = field(x + h / 2 * a)
            c = field(x + h / 2 * b)
            x = x + h / 6 * (a + 2 * b + 2 * c + field(x + h * c))
    quiet: Any = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False}
    program = {"x": durations, "f": casadi.sumsqr(durations), "g": x - casadi.DM(goal)}
    began = time.perf_counter()
    solver = casadi.nlpsol("durations", "ipopt", program, quiet)
    guess = np.random.default_rng(SEED).normal(scale=0.3, size=count)
    found = np.array(solver(x0=guess, lbg=0, ubg=0)["x"])[:, 0]
    took = time.perf_counter() - began
    used = int((np.abs(found) > 1e-6).sum())
    missed = np.linalg.norm(end_of(problem, found) - goal)
    return f"{used}, {missed:.0e} off, {took:.1f} s"


def _casadi_field(problem: Problem, name: str, casadi: Any) -> Any:
    words = ("sin", "cos", "tan")
    functions = {word: getattr(casadi, word) for word in words}
    system = problem.system
    rates = rates_with(system.fields[name], system.state, functions)

    def field(x: Any) -> Any:
        return casadi.vertcat(*rates(*casadi.vertsplit(x)))

    return field


def ompl_cell(problem: Problem) -> str:
    """Flows and distance of RRT over single fields, given `PATIENCE`.

    Args:
        problem: What to reach.
    """
    if find_spec("ompl") is None:
        return ABSENT
    from ompl import base, control, util

    names = generators(problem)
    start, goal = problem.states
    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(SEED)
    size = len(start)
    room = 3 * max(1.0, float(np.abs(goal - start).max()))
    space = base.RealVectorStateSpace(size)
    space.setBounds(-room, room)
    choices = control.RealVectorControlSpace(space, 1)
    bounds = base.RealVectorBounds(1)
    bounds.setLow(-float(len(names)))
    bounds.setHigh(float(len(names)))
    choices.setBounds(bounds)
    setup = control.SimpleSetup(choices)
    setup.setStateValidityChecker(lambda state: space.satisfiesBounds(state))
    fields = [problem.system.compiled(name).velocity for name in names]

    def propagate(state: Any, chosen: Any, duration: float, result: Any) -> None:
        x = np.array([state[i] for i in range(size)])
        field = fields[min(int(abs(chosen[0])), len(names) - 1)]
        h = float(np.copysign(duration, chosen[0]))
        half = x + h / 2 * field(x)
        x = x + h * field(half)
        for i in range(size):
            result[i] = float(x[i])

    setup.setStatePropagator(propagate)
    ends = []
    for values in (start, goal):
        state = space.allocState()
        for i in range(size):
            state[i] = float(values[i])
        ends.append(state)
    way = float(np.linalg.norm(goal - start))
    setup.setStartAndGoalStates(*ends, 0.1 * way)
    information = setup.getSpaceInformation()
    information.setPropagationStepSize(0.05 * way)
    information.setMinMaxControlDuration(1, 40)
    setup.setPlanner(control.RRT(information))
    setup.solve(PATIENCE)
    path = setup.getSolutionPath()
    last = path.getStates()[-1]
    missed = np.linalg.norm([last[i] - goal[i] for i in range(size)])
    return f"{len(path.getControls())}, {missed:.0e} off"
