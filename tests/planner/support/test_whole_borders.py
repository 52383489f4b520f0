"""Borders that numbers reach exactly: the last one taken, and the first beyond."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from planner.errors import BudgetError
from planner.extension.choice import choose_elements
from planner.extension.steering import Steering
from planner.optimisation.stages import Stage
from planner.support import stopping
from planner.systems import closure
from planner.systems.declaration import _is_real
from planner.systems.formulas import _short
from planner.systems.strata import StratifiedSystem

MOST_SIGNED = 4  # generators whose signs are tried, all combinations of them
ZERO_FLOW = 1e-5  # duration; an interior-point method leaves this much of no flow
HUGE = 1e100  # magnitude of a number; a product of three still fits a float
QUOTED = 60  # characters of a formula in a message


def test_a_formula_is_shortened_once_it_is_longer_than_a_line():
    assert _short("x" * QUOTED) == repr("x" * QUOTED)
    assert _short("x" * (QUOTED + 1)) == repr("x" * (QUOTED - 3) + "...")


def test_a_number_is_real_below_the_huge_one():
    assert [_is_real(n) for n in (0.0, 0.99 * HUGE, HUGE, -HUGE)] == [True, True] + [
        False
    ] * 2


def test_a_matrix_has_an_exact_rank_up_to_its_most_entries(monkeypatch):
    x, y = state = sp.symbols("x y")
    fields = [sp.Matrix([x, 1]), sp.Matrix([2 * x, 2])]
    for most, rank in ((4, 1), (3, None)):
        monkeypatch.setattr(closure, "MOST_ENTRIES", most)
        assert closure.exact_rank(fields, state, np.array([0.5, 0.0])) == rank


@pytest.mark.parametrize(
    ("count", "some"), [(MOST_SIGNED, True), (MOST_SIGNED + 1, False)]
)
def test_signs_of_a_few_generators_are_tried_and_of_more_none(count, some):
    hall = SimpleNamespace(entangled=range(count), generators=range(1, count + 1))
    ways = Steering.signs.fget(SimpleNamespace(hall=hall))
    assert (len(ways) > 1) == some
    assert (ways[0] == 1).all()


def test_a_flow_is_negligible_up_to_what_the_solver_leaves_of_none():
    stage = Stage("1", "f", ())
    found = [len(stage.flows(n * ZERO_FLOW, [])) for n in (0.0, 1.0, -1.0, 1.01)]
    assert found == [0, 0, 0, 1]


def test_fields_themselves_are_elements_of_degree_one():
    plane = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")
    assert choose_elements(plane, (0, 0), max_degree=1).elements == ("f", "g")
    with pytest.raises(ValueError, match="max_degree is 0"):
        choose_elements(plane, (0, 0), max_degree=0)


def test_a_search_may_take_all_of_its_time_and_no_more(monkeypatch):
    """And reports as soon as its next report is due."""
    clock, told = [10.0], []
    monkeypatch.setattr(stopping.time, "monotonic", lambda: clock[0])
    budget = SimpleNamespace(
        began=10.0, seconds=4.0, best="", next_report=2.0, report=told.append
    )
    token = stopping._current.set(budget)
    try:
        for clock[0], reports in ((11.9, []), (12.0, [0.5]), (14.0, [0.5, 1.0])):
            stopping.tick()
            assert told == reports
            if reports:  # ten reports a second at most
                assert budget.next_report == pytest.approx(clock[0] - 10.0 + 0.1)
        clock[0] = 14.1
        with pytest.raises(BudgetError):
            stopping.tick()
    finally:
        stopping._current.reset(token)
