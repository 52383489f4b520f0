"""Which solutions a search keeps, improves and passes on, and what it reports."""

from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BudgetError
from planner.optimisation import windows
from planner.optimisation.windows import WindowSearch
from tests.planner.optimisation.stubs import (
    LAST,
    LATER,
    WHOLE,
    Found,
    Solved,
    searching,
)

CHECKED_SHARE = 0.999  # of the tolerances, allowed where they are checked
KEPT_WIDTH = 1.0 + 1e-6  # of the corridor, in tolerances, that counts as keeping them
MOST_STAGES = 96  # of a window


def test_hops_go_on_from_plans_that_are_nearly_as_good():
    first = Found(cost=1.0)
    near, bad = Found(cost=1.0039, first=1), Found(cost=1.0041)
    wide, better = Found(cost=0.1, width=1.1), Found(cost=0.9)
    search = searching(hops=6)
    search._best, search.programs = first, Solved(near, bad, None, wide, better, bad)
    search._hop(WHOLE)
    assert search.programs.guesses == [first, near, near, near, near, better]
    assert search.programs.asked == [(4, 0), *[(4, 1)] * 4, (4, 0)]
    assert search._best is better
    assert set(first.hopped_by) == {2}  # stages of a turn of the cycle
    assert search.reported == pytest.approx(0.3 + 0.7 * np.arange(1, 7) / 6)


def test_hops_to_more_stages_than_a_window_has_are_not_made():
    search = searching(hops=2)
    search._best = Found(count=MOST_STAGES + 1)
    search.programs = Solved()
    search._hop(WHOLE)
    assert search.programs.asked == []
    search._best = Found(count=MOST_STAGES)
    search.programs = Solved(None, None)
    search._hop(WHOLE)
    assert len(search.programs.asked) == 2


@pytest.mark.parametrize(
    ("window", "done", "share"),
    [(WHOLE, 0.25, 0.25), (LATER, 0.0, 0.2), (LATER, 0.5, 0.3), (LAST, 0.5, 0.6)],
)
def test_of_all_windows_but_the_last_a_half_is_kept_and_reported(window, done, share):
    search = searching()
    search._report(window, done)
    assert search.reported == pytest.approx([share])


@pytest.mark.parametrize(
    ("relaxed", "least", "again"),
    [
        (Found(cost=1.0), None, True),
        (Found(cost=1.0), 1.5, True),
        (Found(cost=1.0), 1.0, False),  # no better even without
        (Found(cost=1.0, width=KEPT_WIDTH), None, True),
        (Found(cost=1.0, width=1.0 + 1.1e-6), None, False),
        (None, None, False),
    ],
)
def test_soft_constraints_are_added_to_what_can_be_better(relaxed, least, again):
    search = searching(soft=True)
    search.without_soft, trial = False, (4, 1, 0)
    search._relaxed, search.programs = Solved(relaxed), Solved(Found(width=0.5))
    search._best = None if least is None else Found(cost=least)
    found = search._solved(WHOLE, trial, np.zeros(4))
    assert search._relaxed.asked == [(4, 1)]
    assert search.programs.asked == [(4, 1)] * again
    if again:
        assert found.width == 0.5 / CHECKED_SHARE
        (guess,) = search.programs.guesses
        assert (guess.width, guess.cost) == (np.inf, 1.0)
    else:
        assert found is None
    search.without_soft = True
    assert search._solved(WHOLE, trial, np.zeros(4)) is relaxed  # solved once
    assert search._relaxed.asked == [(4, 1)]


@pytest.mark.parametrize(
    ("best", "found", "kept"),
    [
        (None, Found(9.0, 3.0), "found"),
        (Found(1.0, 2.0), None, "best"),
        (Found(1.0, 2.0), Found(9.0, 1.5), "found"),  # nearer to the tolerances
        (Found(1.0, 2.0), Found(0.1, 2.5), "best"),
        (Found(1.0, KEPT_WIDTH), Found(0.1, 1.5), "best"),
        (Found(1.0, KEPT_WIDTH), Found(0.1, KEPT_WIDTH), "found"),
        (Found(1.0, 0.9), Found(1.1, 0.1), "best"),
    ],
)
def test_the_best_solution_keeps_tolerances_and_is_then_the_shortest(best, found, kept):
    search = searching()
    search._best = best
    search._keep(found)
    assert search._best is {"best": best, "found": found}[kept]
    keeps = found is not None and found.width <= KEPT_WIDTH
    assert search._kept_plans == [found] * keeps


def test_the_best_so_far_is_told_with_its_place(monkeypatch):
    told = []
    monkeypatch.setattr(windows, "tick", told.append)
    search = searching(soft=True)
    search._keep(Found(1.0))
    assert told == search._kept_plans == []  # it lacks soft constraints
    search._best, search.without_soft = None, False
    search._keep(Found(1.0, count=7))
    search._keep(Found(2.0))
    assert told == ["7 stages that begin at 25% of the path"]


def test_plans_are_solved_again_for_larger_tolerances_from_near_first(monkeypatch):
    best, other = Found(1.0), Found(1.1)
    one, wide, two, three = Found(0.9), Found(0.1, 1.5), Found(0.95), Found(0.8)
    solved = {"0": Solved(one, wide, two), "1": Solved(None, None), "2": Solved(three)}
    search = searching()
    monkeypatch.setattr(windows, "programs_of", lambda task, path: solved[task])
    search._best, search._kept_plans = best, [other, best]
    assert search.fitted(WHOLE, "012") == [best, one, one, three]
    assert solved["0"].guesses == [best, other, other]
    assert solved["0"].near == [True, True, False]
    assert solved["1"].guesses == [one, one]
    assert solved["2"].guesses == [one]
    search._best, search._kept_plans = None, []
    assert search.fitted(WHOLE, "") == []


class Stop(KeyboardInterrupt):
    """Ends a search at once, whatever it has found."""


@pytest.mark.parametrize(
    ("error", "window", "width", "soft", "passed_on"),
    [
        (KeyboardInterrupt(), WHOLE, 1.0, False, False),
        (KeyboardInterrupt(), LATER, 1.0, False, False),
        (BudgetError(1.0, ""), LATER, 1.0, False, True),
        (BudgetError(1.0, ""), LAST, 1.0, False, False),
        (KeyboardInterrupt(), WHOLE, 1.1, False, True),
        (KeyboardInterrupt(), WHOLE, None, False, True),
        (KeyboardInterrupt(), WHOLE, 1.0, True, True),
        (Stop(), WHOLE, 1.0, False, True),
    ],
)
def test_a_stop_is_passed_on_unless_a_plan_of_the_whole_path_is_left(
    error, window, width, soft, passed_on
):
    search = searching(soft)
    search._left, search._kept_plans = 0.1, [Found()]
    search._guesses[1, 2, 3] = None

    def explore(window, count):
        assert (search._left, search._best) == (1.0, None)
        assert not search._guesses
        assert not search._kept_plans
        assert search.without_soft == soft
        search._best = None if width is None else Found(width=width)
        raise error

    search._explore = explore
    if passed_on:
        with pytest.raises(type(error)):
            search.solve(window, 5)
    else:
        assert search.solve(window, 5) is search._best
    assert search.hurried == (not passed_on)


def test_programs_are_built_once_for_all_stages_that_begin_alike(monkeypatch):
    built = Counter()

    def program(task, path, count, first):
        built[count, first] += 1
        return count, first

    monkeypatch.setattr(windows, "Program", program)
    programs = windows.programs_of(SimpleNamespace(stages=("a", "b")), None)
    assert [programs(4, 0), programs(4, 3), programs(4, 2)] == [(4, 0), (4, 1), (4, 0)]
    assert built == {(4, 0): 1, (4, 1): 1}


def test_only_the_first_window_begins_the_path():
    assert WHOLE.begins
    assert not LATER.begins
    assert (WindowSearch.hops, WindowSearch.hurried) == (0, False)
