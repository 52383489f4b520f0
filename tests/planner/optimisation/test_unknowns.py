"""The vector of an optimised plan: what is packed is unpacked, within its bounds."""

from dataclasses import replace

import numpy as np
import pytest

from planner.optimisation.constraints import path_distance
from planner.optimisation.corridor import Tolerance
from planner.optimisation.program import Unknowns
from planner.optimisation.task import Inequality, Solution
from tests.planner.optimisation.step import SPAN, STEP, optimised

GUESSED_WIDTH = 4.0  # largest width of the corridor, in tolerances, of a guess

COUNT = 4
START = np.zeros(7)


@pytest.fixture
def task():
    return optimised().task


def unknowns(task):
    return Unknowns(task, 0, COUNT, 0.5)


def solution(task):
    """Any motion whose states differ from the start in what is unknown alone."""
    rng = np.random.default_rng(4)
    states = np.tile(START, (COUNT + 1, 1))
    states[:, task.moved] = rng.normal(size=(COUNT + 1, len(task.moved)))
    recoveries = rng.normal(size=(COUNT, task.most_recoveries))
    places = np.linspace(0, 1, COUNT + 1)
    return Solution(0, rng.normal(size=COUNT), recoveries, states, places, 3.0, 0.7)


@pytest.mark.parametrize("overlapped", [False, True])
def test_what_is_packed_is_unpacked_again(task, overlapped):
    own = unknowns(replace(task, overlapped=overlapped))
    given = solution(task)
    read = own.unpacked(own.packed(given), 3.0, START)
    for name in ("strokes", "recoveries", "states", "places"):
        assert getattr(read, name).tolist() == getattr(given, name).tolist()
    assert (read.first, read.cost, read.width) == (0, 3.0, 0.7)


@pytest.mark.parametrize("overlapped", [False, True])
def test_a_vector_has_as_many_entries_as_the_program_has_symbols(task, overlapped):
    pytest.importorskip("casadi")
    own = unknowns(replace(task, overlapped=overlapped))
    size = sum(symbol.numel() for symbol in own.symbols())
    low, high = own.bounds(START, (0.0, 1.0), START, 0.0)
    assert len(own.packed(solution(task))) == len(low) == len(high) == size


def test_a_guess_has_a_corridor_of_limited_width(task):
    own = unknowns(task)
    endless = replace(solution(task), width=np.inf)
    assert own.packed(endless)[-1] == GUESSED_WIDTH


def test_bounds_hold_ends_and_limits_and_leave_the_rest_free(task):
    own = unknowns(task)
    goal = np.array([0.5, 0.4, 0.1, 0.0, 0.0, 0.0, 0.0])
    ends = own.bounds(START, (0.2, 0.8), goal, 0.3)
    moved, first = task.moved, (COUNT + 1) * (len(task.moved) + 1)  # of the amounts
    for strokes in (
        slice(first, first + COUNT),
        slice(first + COUNT, first + 2 * COUNT),
    ):
        assert not ends[0][strokes].any()
        assert ends[1][strokes].tolist() == own.longest.tolist()
    with np.errstate(invalid="ignore"):  # differences of amounts without bounds
        low, high = (own.unpacked(values, 0.0, START) for values in ends)
    for end in (low, high):
        assert end.states[0][moved].tolist() == START[moved].tolist()
        assert end.states[-1][moved].tolist() == goal[moved].tolist()
        assert (end.places[0], end.places[-1]) == (0.2, 0.8)
    assert low.places[1:-1] == pytest.approx(np.full(COUNT - 1, 0.2))
    assert high.places[1:-1] == pytest.approx(np.full(COUNT - 1, 0.8))
    for i in moved:
        most = SPAN if i in task.limits else np.inf
        assert (low.states[1:-1, i] == -most).all()
        assert (high.states[1:-1, i] == most).all()
    assert (low.width, high.width) == (0.3, np.inf)
    free = own.bounds(START, (0.2, 0.8), None, 0.3)[1]
    assert free[COUNT * len(moved)] == np.inf  # the first coordinate of the last state


def test_no_stroke_is_longer_than_its_leg_s_range(task):
    """Recoveries put a leg at one end, and the stroke goes to the other."""
    own = unknowns(task)
    for stage, longest in zip(own.stages, own.longest, strict=True):
        rates = task.rates(stage)
        ranges = [2 * SPAN / abs(rate) for i, rate in rates.items() if i in task.limits]
        assert longest == pytest.approx(min(ranges))
    uneven = replace(task, limits={3: (-0.2, 0.6), 4: (-0.6, 0.2)})
    assert unknowns(uneven).longest == pytest.approx(own.longest * 0.8 / (2 * SPAN))
    centred = unknowns(replace(uneven, centred=True)).longest
    assert centred == pytest.approx(own.longest * 0.4 / (2 * SPAN))


def test_strokes_without_limits_are_bounded_by_the_path_s_size(task):
    free = replace(task, limits={})
    assert Unknowns(free, 0, COUNT, 0.5).longest == pytest.approx(np.full(COUNT, 2.0))
    assert Unknowns(free, 0, COUNT, 5.0).longest == pytest.approx(np.full(COUNT, 10.0))


def test_recoveries_centre_every_later_stroke_on_zero(task):
    own = unknowns(task)
    strokes, recoveries = own.centred(np.array([0.2, -0.1, 0.3, 9.0]), START)
    assert strokes == pytest.approx([0.2, -0.1, 0.3, own.longest[3]])
    now = START.copy()
    for k, stage in enumerate(own.stages):
        for recovery, amount in zip(stage.recoveries, recoveries[k], strict=False):
            now[recovery.coordinate] += amount * recovery.rate
        before = now.copy()
        for i, rate in task.rates(stage).items():
            now[i] += rate * strokes[k]
            if k and i in task.limits:  # nothing came before the first one
                assert before[i] == pytest.approx(-now[i])


def test_sizes_are_what_strokes_change_and_alike_within_a_tolerance(task):
    start = np.array([0.0, 0.0, 0.7, 0.1, -0.2, 0.0, 0.0])
    strokes = [stage.stroke for stage in task.stages]
    columns = np.abs([task.system.compiled(name).velocity(start) for name in strokes])
    found = dict(zip(task.moved, task.sizes(start), strict=True))
    most = columns.max(axis=0)
    assert found[0] == found[1] == max(most[0], most[1])
    for i in task.moved[2:]:
        assert found[i] == (most[i] or 1.0)
    assert task.unit(start) == min(found.values())
    apart = replace(task, tolerances=(Tolerance((0,), 0.5), Tolerance((1,), 0.5)))
    assert apart.sizes(start)[:2].tolist() == most[:2].tolist()


def test_with_soft_constraints_every_stage_has_a_width_of_its_own(task):
    soft = Inequality("gap", lambda stage, state: [state[0]], relaxed=True)
    hard = replace(soft, relaxed=False)
    for inequality, count in ((soft, COUNT), (hard, 1)):
        assert unknowns(replace(task, inequalities=(inequality,))).widths == count
    assert unknowns(task).widths == 1


@pytest.mark.parametrize(
    ("position", "yaw", "powers"),
    [(0.5, 1.0, [2, 1, 1]), (0.5, np.inf, [2]), (np.inf, 1.0, [1, 1])],
)
def test_coordinates_with_endless_tolerances_are_free(task, position, yaw, powers):
    tolerances = Tolerance((0, 1), position), Tolerance((2,), yaw), Tolerance((6,), 1.0)
    free = replace(task, tolerances=tolerances)  # foot heights are no unknowns
    assert path_distance(free, STEP)[1] == powers
