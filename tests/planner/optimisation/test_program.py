"""Cost and constraints of the nonlinear program, against the motion of its flows."""

from dataclasses import replace

import numpy as np
import pytest

from planner.optimisation import program as programs
from planner.optimisation.constraints import Margins, curve_function, stage_function
from planner.optimisation.program import Program
from planner.optimisation.task import Inequality, Solution
from planner.planning.paths import as_path, line
from planner.planning.rollouts import play
from planner.systems.flows import Flow
from tests.planner.optimisation.step import POSITION, SPAN, STEP, YAW, optimised

CHECKED_SHARE = 0.999  # of the tolerances, allowed where they are checked
STAGE_STEPS = 3  # of Runge and Kutta's method; the path is compared after each
TINY = 1e-12  # added to denominators that may be zero
OVERLAPPED_COST = 1e-2  # weight of overlapped flows, so that none is made in vain

ca = pytest.importorskip("casadi")

COUNT, FIRST = 3, 1
START = np.array([0.02, -0.03, 0.1, 0.05, -0.07, 0.0, 0.0])
WAY = line(START, START + [0.4, 0.3, 0.5, 0, 0, 0, 0])
PRICE = {"g1_1": 1.5, "g2_2": 2.5, "g1_2": 0.7, "g2_1": 0.3}
ROOM = Inequality("room", lambda stage, state: [1.0 - state[3] ** 2, state[4] + 1.0])
SOFT = Inequality("gap", lambda stage, state: [state[0] + state[3]], relaxed=True)


def task_of(**changes):
    return replace(optimised(path=WAY).task, price=PRICE, **changes)


@pytest.fixture
def built(monkeypatch):
    """Build a program, and its cost and constraints as functions of the unknowns."""

    def build(task):
        given = []
        monkeypatch.setattr(programs, "Ipopt", lambda *parts: given.append(parts))
        program = Program(task, WAY, COUNT, FIRST)
        ((expressions, options),) = given
        names = "x", "f", "g"
        parts = [expressions[name] for name in names]
        values = ca.Function("program", parts[:1], parts[1:])
        return program, options, lambda x: [np.array(v)[:, 0] for v in values(x)]

    return build


def vector(program, seed=3):
    """Any unknowns, with both directions of every stroke and recovery."""
    rng = np.random.default_rng(seed)
    size = sum(symbol.numel() for symbol in program.unknowns.symbols())
    return rng.uniform(0.1, 0.9, size=size)


def split(program, x):
    """The unknowns by name, as in the program's symbols."""
    symbols = program.unknowns.symbols()
    ends = np.cumsum([symbol.numel() for symbol in symbols])
    parts = np.split(x, ends[:-1])
    names = ["states", "places", "forward", "backward", "up", "down", "times", "width"]
    return {
        name: part.reshape(symbol.shape, order="F")
        for name, symbol, part in zip(names, symbols, parts, strict=True)
    }


def whole(task, moved):
    state = START.copy()
    state[task.moved] = moved
    return state


def steps(task, stage, x, d, amounts):
    """States after each step, of Runge and Kutta's method once more."""
    speed = np.zeros(7)
    if not task.centred:
        for recovery, amount in zip(stage.recoveries, amounts, strict=False):
            speed[recovery.coordinate] += recovery.rate * amount
    x, h, found = np.array(x), 1 / STAGE_STEPS, []
    during = speed if task.overlapped else 0.0
    x = x if task.overlapped else x + speed
    field = task.system.compiled(stage.stroke)

    def rate(y, u):
        y = y.copy()
        if task.centred:
            for i, r in task.rates(stage).items():
                if i not in task.moved:
                    y[i] = (u - 0.5) * d * r
        return field.velocity(y) * d + during

    for k in range(STAGE_STEPS):
        a = rate(x, k * h)
        b = rate(x + h / 2 * a, (k + 0.5) * h)
        c = rate(x + h / 2 * b, (k + 0.5) * h)
        e = rate(x + h * c, (k + 1) * h)
        x = x + h / 6 * (a + 2 * b + 2 * c + e)
        found.append(x)
    return found


def off(task, state, place, width):
    """How far outside of the corridor a state is, as the program has it."""
    ahead, along = (state - WAY(place))[:2], (WAY(1.0) - WAY(0.0))[:2]
    nearest = place + ahead @ along / (along @ along + TINY)
    turned = (state - WAY(nearest))[2] / YAW
    return [
        (ahead / POSITION) @ (ahead / POSITION) - width**2,
        turned - width,
        -turned - width,
    ]


def inequalities(task, program, k, stage, parts):
    """Values of the inequalities as a stage begins, has recovered and ends."""
    begin, end = (whole(task, parts["states"][:, i]) for i in (k, k + 1))
    mixed = begin.copy()
    for recovery in stage.recoveries:
        mixed[recovery.coordinate] = end[recovery.coordinate]
    found, unit = [], task.unit(WAY(0.0))
    excess = parts["width"].ravel()[min(k, parts["width"].size - 1)] - CHECKED_SHARE
    for place, state in enumerate((begin, mixed, end)):
        for inequality in task.inequalities:
            if not (inequality.relaxed and task.overlapped and place == 1):
                slack = excess if inequality.relaxed else 0.0
                values = inequality.expressions(stage, state)
                found += [value / unit + slack for value in values]
    return found


KINDS = [
    {},
    {"overlapped": True},
    {"centred": True},
    {"inequalities": (ROOM,)},
    {"inequalities": (ROOM, SOFT)},
    {"inequalities": (SOFT, ROOM), "overlapped": True},
]


@pytest.mark.parametrize("changes", KINDS, ids=lambda changes: "-".join(changes))
def test_cost_and_constraints_are_those_of_the_motion(built, changes):
    task = task_of(**changes)
    program, options, evaluate = built(task)
    assert options == {"expand": True}  # for a straight path
    x = vector(program)
    parts = split(program, x)
    cost, rows = evaluate(x)

    strokes = (parts["forward"] + parts["backward"]).ravel()
    recoveries = parts["up"] + parts["down"]
    D = (parts["forward"] - parts["backward"]).ravel()
    A = parts["up"] - parts["down"]
    widths, S, X = parts["width"].ravel(), parts["places"].ravel(), parts["states"]
    stages = [task.stage(FIRST + k) for k in range(COUNT)]
    prices = [PRICE[stage.stroke] * s for stage, s in zip(stages, strokes, strict=True)]
    for k, stage in enumerate(stages):
        for j, recovery in enumerate(stage.recoveries):
            prices.append(PRICE[recovery.field] * recoveries[j, k])
    expected = sum(prices)
    if task.overlapped:
        expected = parts["times"].sum() + OVERLAPPED_COST * expected
    assert cost == pytest.approx(expected + 1000 * 2.5 * widths[-1])

    found, corridor, numbers = [], [], []
    for stage in dict.fromkeys(stages):
        here = [k for k in range(COUNT) if stages[k] == stage]
        moved = {
            k: steps(task, stage, whole(task, X[:, k]), D[k], A[:, k]) for k in here
        }
        scale = task.sizes(WAY(0.0))
        for k in here:
            found += ((X[:, k + 1] - moved[k][-1][task.moved]) / scale).tolist()
        for k in here:
            found += inequalities(task, program, k, stage, parts)
        for j in range(STAGE_STEPS):
            for k in here:
                last = j == STAGE_STEPS - 1
                state = whole(task, X[:, k + 1]) if last else moved[k][j]
                place = S[k] + (S[k + 1] - S[k]) * (j + 1) / STAGE_STEPS
                width = widths[k] if widths.size > 1 else widths[0]
                corridor += off(task, state, place, width)
                numbers += [-1 if last and k == COUNT - 1 else k] * 3
    found += corridor
    found += np.diff(widths).tolist() + np.diff(S).tolist()
    free = len(found)
    if task.overlapped:
        times = parts["times"].ravel()
        for k, stage in enumerate(stages):
            found.append(times[k] - PRICE[stage.stroke] * strokes[k])
            for j, recovery in enumerate(stage.recoveries):
                found.append(times[k] - PRICE[recovery.field] * recoveries[j, k])
    assert rows == pytest.approx(np.array(found))

    low, high = program._constraints.bounds()
    equal = len(task.moved) * COUNT
    assert (low == high).sum() == equal + len(widths) - 1
    at_most = np.flatnonzero((low == -np.inf) & (high == 0.0))
    first = free - len(corridor) - (len(widths) - 1) - COUNT
    assert at_most.tolist() == list(range(first, first + len(corridor)))
    rest = np.delete(np.arange(len(rows)), at_most)
    assert (low[rest] == 0.0).all()
    assert np.isin(high[rest], [0.0, np.inf]).all()

    shares = np.array([0.7, 0.8, 0.9])
    asked = Margins(shares, np.zeros((COUNT, len(task.inequalities))))
    tight = program._constraints.bounds(asked)[1][at_most]
    own = np.append(shares, 1.0)[numbers]  # none for the last state, which is fixed
    powers = np.tile([2, 1, 1], len(numbers) // 3)
    # squares of distances are compared with squares of the width
    least = CHECKED_SHARE**powers
    assert tight == pytest.approx(-(least - (CHECKED_SHARE * own) ** powers))


@pytest.mark.parametrize("overlapped", [False, True])
def test_the_steps_of_a_stage_follow_its_flows_to_the_fourth_order(overlapped):
    task = task_of(overlapped=overlapped)
    system, missed = task.system, []
    for size in (0.5, 0.25):
        for stage in task.stages:
            (recovery,) = stage.recoveries
            given = START[task.moved], size, [0.0 if overlapped else 0.3]
            end = np.array(stage_function(task, stage, WAY(0.0))(*given))[:, -1]
            flows = [Flow(stage.stratum, stage.stroke, size)]
            if not overlapped:
                flows.insert(0, Flow(stage.stratum, recovery.field, 0.3))
            exact = play(system, flows, START)[-1][task.moved]
            missed.append(np.abs(end - exact).max())
    coarse, fine = max(missed[:2]), max(missed[2:])
    assert 2**4.5 < coarse / fine < 2**5.5
    assert coarse < 1e-5


def test_a_bent_path_is_a_spline_that_meets_it():
    still = np.zeros(4)
    turn = as_path(lambda s: np.array([np.sin(s), 1 - np.cos(s), s, *still]))
    moved = [0, 1, 2]
    curve, straight = curve_function(turn, moved)
    s = ca.MX.sym("s")
    values = ca.Function("curve", [s], [curve(s)])
    assert not straight
    for place in (0.0, 0.1234, 0.77, 1.0):
        assert np.array(values(place))[:, 0] == pytest.approx(
            turn(place)[moved], abs=1e-6
        )
    curve, straight = curve_function(WAY, moved)
    assert straight
    assert np.array(curve(0.3))[:, 0] == pytest.approx(WAY(0.3)[moved])
    for size, straight in ((1.0, False), (1e3, True)):  # but for rounding
        near = line(size * START, size * WAY(1.0))
        bent = as_path(lambda s, near=near: near(s) + 1e-8 * np.sin(np.pi * s))
        assert curve_function(bent, moved)[1] == straight


def test_a_first_guess_is_the_motion_of_centred_strokes(built):
    program, _, _ = built(task_of())
    task, places = program.task, (0.2, 0.8)
    guess = program.guess(np.array([0.2, -0.3, 9.0]), START, places)
    strokes, recoveries = program.unknowns.centred(np.array([0.2, -0.3, 9.0]), START)
    assert guess.strokes.tolist() == strokes.tolist()
    assert guess.recoveries.tolist() == recoveries.tolist()
    state = START
    for k, stroke in enumerate(strokes):
        state = steps(task, task.stage(FIRST + k), state, stroke, recoveries[k])[-1]
        assert guess.states[k + 1] == pytest.approx(state)
    assert guess.places == pytest.approx(np.linspace(0.2, 0.8, COUNT + 1))
    assert guess.states[0].tolist() == START.tolist()
    assert (guess.first, guess.cost, guess.width) == (FIRST, np.inf, np.inf)


def test_the_cost_of_a_solution_is_that_of_its_flows():
    """Without the corridor's width, which a program adds to it."""
    task = task_of()
    found = Program(task, STEP, 4).solve(
        Program(task, STEP, 4).guess(
            np.array([0.3, -0.3, 0.3, -0.3]), STEP(0.0), (0, 1)
        ),
        (0.0, 1.0),
        STEP(1.0),
    )
    assert isinstance(found, Solution)
    paid = 0.0
    for k, stroke in enumerate(found.strokes):
        stage = task.stage(k)
        paid += PRICE[stage.stroke] * abs(stroke)
        for recovery, amount in zip(stage.recoveries, found.recoveries[k], strict=True):
            paid += PRICE[recovery.field] * abs(amount)
    assert found.cost == pytest.approx(paid, abs=1e-4)
    assert np.abs(found.states[:, 3:5]).max() <= SPAN + 1e-6
    assert found.states[-1] == pytest.approx(STEP(1.0), abs=1e-6)
