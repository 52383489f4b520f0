"""Accuracy of the planner on every shipped system, and other planners, as a table.

CasADi and OMPL, where they are installed, get the same goal. Their controls are the
fields that the system's elements are made of, one at a time; a plan is a sequence of
strokes, and its cost is the sum of their lengths.

Example:
    python -m scripts.planner_table docs/planner-table.md
"""

import json
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import planner
from models import SYSTEMS, Problem, shipped_system
from planner.optimisation import casadi_function
from planner.systems import merged
from scripts.pages import parser_of, tabulate

COUNTS = (32, 64)  # segments between which the order is measured
HEADER = (
    "system | degree | order expected | measured | critical step | length of the way | "
    "shots to 1e-9 | flows | CasADi | OMPL"
)
STEPS = 8  # of Runge and Kutta's method for a stroke of IPOPT's
GUESS = 0.1  # of every stroke
SAMPLING_TIME = 3.0  # [s] of OMPL
SEED = 1  # time still decides how far samplers get


def row(name: str) -> tuple[object, ...]:
    """The line of the table for one shipped system."""
    problem = shipped_system(name)
    extended = planner.extend(problem.system, problem.elements)
    start, goal = problem.states
    expected = planner.convergence_order(extended, problem.path, "backward")
    exact = math.isinf(expected.order)
    step = planner.critical_step(extended, start, goal - start)
    return (
        name,
        expected.degree,
        "exact" if exact else f"{expected.order:.3g}",
        "exact" if exact else f"{_measured(problem, extended):.2f}",
        "any" if math.isinf(step) else f"{step:.3g}",
        f"{np.linalg.norm(goal - start):.3g}",
        *_shots(problem, extended),
        *(_peer(problem, solve) for solve in (optimised, sampled)),
    )


def _measured(problem: Problem, extended: planner.ExtendedSystem) -> float:
    """The order with which the distance from the goal falls."""
    path = planner.line(*problem.states)
    how = problem.execution
    plans = (planner.plan(extended, path, n, execution=how) for n in COUNTS)
    misses = [np.linalg.norm(planner.rollout(p)[-1] - problem.states[1]) for p in plans]
    return math.log2(misses[0] / misses[1])


def _shots(problem: Problem, extended: planner.ExtendedSystem) -> tuple[object, object]:
    try:
        free = replace(problem.execution, limits={}, stance="paper")
        steered = planner.steer(extended, *problem.states, free)
    except planner.PlannerError:
        return "none", "none"
    return len(steered.distances) - 1, len(steered.plan.flows)


def _peer(problem: Problem, solve: Callable[[Problem], list[planner.Flow]]) -> str:
    """Strokes of a peer's plan, its distance from the goal, and its time."""
    began = time.perf_counter()
    try:
        strokes = solve(problem)
    except ImportError:
        return "not installed"
    took = time.perf_counter() - began
    end = planner.play(problem.system, strokes, problem.states[0])[-1]
    missed = float(np.linalg.norm(end - problem.states[1]))
    return f"{len(strokes)}, {missed:.0e} off, {took:.1f} s"


def _stroke(problem: Problem, name: str, duration: float) -> planner.Flow:
    return planner.Flow(problem.system.stratum_of[name], name, duration)


def controls(problem: Problem) -> tuple[str, ...]:
    """Names of the fields that a problem's elements are made of."""
    return planner.extend(problem.system, problem.elements).steering.hall.generators


def optimised(problem: Problem) -> list[planner.Flow]:
    """The least strokes by CasADi and IPOPT, multiple shooting from one guess.

    States between strokes are unknowns like the durations, so that a poor first guess
    does not distort the whole path.
    """
    import casadi

    names = controls(problem) * 6  # uses of every field at most
    (start, goal), count = problem.states, len(names)
    forward, back = (casadi.SX.sym(name, count) for name in ("forward", "back"))
    states = casadi.SX.sym("states", len(start), count)
    flows = {name: _flow(problem, name, casadi) for name in dict.fromkeys(names)}
    before: Any = casadi.DM(start)
    gaps = [states[:, -1] - casadi.DM(goal)]
    for k, name in enumerate(names):
        after = flows[name](before, [], forward[k] - back[k])
        before = states[:, k]
        gaps.append(after - before)
    program = {
        "x": casadi.vertcat(forward, back, casadi.vec(states)),
        "f": casadi.sum1(forward + back),
        "g": casadi.vertcat(*gaps),
    }
    quiet: Any = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False}
    guess = [_stroke(problem, name, GUESS) for name in names]
    passed = planner.play(problem.system, guess, start)[1:]
    found = casadi.nlpsol("shooting", "ipopt", program, quiet)(
        x0=np.concatenate([np.full(count, GUESS), np.zeros(count), np.ravel(passed)]),
        lbx=np.repeat([0.0, -np.inf], [2 * count, len(start) * count]),
        lbg=0,
        ubg=0,
    )
    ahead, behind = np.array(found["x"])[: 2 * count, 0].reshape(2, count)
    named = zip(names, (ahead - behind).tolist(), strict=True)
    strokes = (_stroke(problem, *each) for each in named)
    # the interior point leaves a little of what it does not need
    return [*merged(s for s in strokes if abs(s.duration) > 1e-6)]


def _flow(problem: Problem, name: str, casadi: Any) -> Any:
    """The state after a field is followed, by Runge and Kutta's method, in symbols."""
    field, state = problem.system.fields[name], problem.system.state
    x, none = casadi.SX.sym("x", len(state)), casadi.SX.sym("none", 0)
    rates = casadi_function(state, tuple(field))(x)
    motion = casadi.Function("motion", [x, none], [casadi.vertcat(*rates)])
    return casadi.simpleRK(motion, STEPS)


def sampled(problem: Problem, seconds: float = SAMPLING_TIME) -> list[planner.Flow]:
    """Strokes that RRT of OMPL finds in time, near the goal or not.

    The propagator is called from C++ in Python, so that it sees far fewer samples in a
    second than it would natively.
    """
    from ompl import base, control, util

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(SEED)
    names, system, (start, goal) = controls(problem), problem.system, problem.states
    way, size, count = float(np.linalg.norm(goal - start)), len(start), len(names)
    room = 3 * max(1.0, float(np.abs(goal - start).max()))
    space = base.RealVectorStateSpace(size)
    space.setBounds(-room, room)
    choices = control.RealVectorControlSpace(space, 1)
    bounds = base.RealVectorBounds(1)
    bounds.setLow(-float(count))
    bounds.setHigh(float(count))
    choices.setBounds(bounds)
    setup = control.SimpleSetup(choices)
    setup.setStateValidityChecker(lambda state: space.satisfiesBounds(state))
    rates = {name: system.compiled(name).velocity for name in names}

    def stroke(chosen: Any, duration: float) -> planner.Flow:
        """The sign of the control is the stroke's, its size says which field."""
        name = names[min(int(abs(chosen[0])), count - 1)]
        return _stroke(problem, name, math.copysign(duration, chosen[0]))

    def set_to(state: Any, values: planner.Array) -> Any:
        for i, value in enumerate(values.tolist()):
            state[i] = value
        return state

    def propagate(state: Any, chosen: Any, duration: float, result: Any) -> None:
        x = np.array([state[i] for i in range(size)])
        _, name, h = stroke(chosen, duration)
        set_to(result, x + h * rates[name](x + h / 2 * rates[name](x)))

    setup.setStatePropagator(propagate)
    ends = (set_to(space.allocState(), values) for values in (start, goal))
    setup.setStartAndGoalStates(*ends, 0.1 * way)  # where sampling ends
    information = setup.getSpaceInformation()
    fastest = max(float(np.abs(rate(start)).max()) for rate in rates.values())
    information.setPropagationStepSize(0.05 * way / fastest)
    information.setMinMaxControlDuration(1, 40)  # of these steps
    setup.setPlanner(control.RRT(information))
    setup.solve(seconds)
    path = setup.getSolutionPath()
    runs = zip(path.getControls(), path.getControlDurations(), strict=True)
    return [stroke(chosen, duration) for chosen, duration in runs]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, or put it in the place of the one in a file."""
    parser = parser_of(__doc__)
    parser.add_argument("file", type=Path, nargs="?", help="Markdown file with a table")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args(arguments)
    if options.json:
        names = HEADER.split(" | ")
        rows = [dict(zip(names, row(one), strict=True)) for one in SYSTEMS]
        print(json.dumps(rows, indent=1))
        return
    tabulate(HEADER, map(row, SYSTEMS), options.file)


if __name__ == "__main__":
    main()
