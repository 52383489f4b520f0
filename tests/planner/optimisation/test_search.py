"""A long path is cut into windows, which grow shorter where no plan is found."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BoundError, BudgetError
from planner.optimisation.constraints import Margins
from planner.optimisation.corridor import Tolerance
from planner.optimisation.search import Search, _first_count
from planner.optimisation.task import Inequality, Solution
from planner.planning.paths import line
from tests.planner.optimisation.stubs import LATER, WHOLE, Solved

CHECKED_SHARE = 0.999  # of the tolerances, allowed where they are checked
KEPT_WIDTH = 1.0 + 1e-6  # of the corridor, in tolerances, that counts as keeping them

SIZES = np.array([0.5, 2.0])  # of a stroke's change


def searching(length, inequalities=(), rungs=()):
    """A search along a path of so many strokes, of which the first counts most."""
    task = SimpleNamespace(
        stages=("a", "b"), moved=[0, 2], sizes=lambda start: SIZES, unit=lambda x: 0.5,
        tolerances=(Tolerance((0,), 0.04), Tolerance((2,), 0.1)), rungs=rungs,
        inequalities=inequalities,
    )  # fmt: skip
    task.relaxed = task.rounded = task
    way = line(np.zeros(3), np.array([0.5, 9.0, 1.0]) * length)
    reported = []
    search = Search(task, way, lambda s: s.cost, report=reported.append)
    search.reported = reported
    return search


def solution(window, count=4, width=1.0):
    """Stages at even distances, of a motion along the path."""
    places = np.linspace(*window.ends, count + 1)
    states = places[:, None] * np.ones(3)
    amounts = np.zeros(count), np.zeros((count, 1))
    return Solution(window.first, *amounts, states, places, 1.0, width)


def along(search, solve, rungs=()):
    """The windows that are tried, with their numbers of stages, and what is done."""
    tried = []

    def noted(window, count):
        tried.append((window, count))
        return solve(window)

    search.solve = noted
    search.fitted = lambda window, rungs: []
    return tried, search._along(rungs)


@pytest.mark.parametrize(
    ("length", "count"), [(0.0, 3), (0.3, 3), (0.31, 3), (0.41, 4), (1.5, 15), (9, 32)]
)
def test_a_search_begins_with_ten_stages_a_stroke_from_three_to_32(length, count):
    assert _first_count(length) == count
    tried, _ = along(searching(length), solution)
    assert tried[0][1] == count


@pytest.mark.parametrize("length", [1e-12, 1.0, 14.9, 15.1])
def test_a_short_path_is_a_single_window_with_its_goal(length):
    search = searching(length)
    ((window, _),), done = along(search, solution)
    assert window.ends == (0.0, 1.0)
    assert window.goal.tolist() == search.path(1.0).tolist()
    assert (len(done), window.first) == (1, 0)
    assert search.reported == [1.0]


def test_of_every_window_but_the_last_a_half_is_kept():
    search = searching(30.0)  # two windows long
    tried, done = along(search, solution)
    ends = [window.ends for window, _ in tried]
    assert ends == [(0, 0.5), (0.25, 0.75), (0.5, 1.0)]
    assert [window.first for window, _ in tried] == [0, 2, 4]
    assert [window.goal is None for window, _ in tried] == [True, True, False]
    assert [count for _, count in tried] == [32, 4, 4]  # as many as before
    assert [len(part.strokes) for part in done] == [2, 2, 4]
    assert [window.start[0] for window, _ in tried] == [0.0, 0.25, 0.5]
    assert search.reported == [0.25, 0.5, 1.0]


@pytest.mark.parametrize(
    ("needed", "shorter"),
    [(None, 2), (1.1, 2), (1.5, 2.25), (3.0, 9), (5.0, 16)],
)
def test_a_window_is_shortened_by_the_square_of_the_width_it_needs(needed, shorter):
    refused = []

    def solve(window):
        if not refused:
            refused.append(window)
            return needed and solution(window, width=needed)
        return solution(window)

    tried, _ = along(searching(2.0), solve)
    assert tried[0][1] == 20
    assert tried[1][0].ends == pytest.approx((0.0, 1 / shorter))
    assert tried[1][1] == max(3, int(20 / shorter))


def test_what_keeps_its_tolerances_is_no_reason_for_shorter_windows():
    tried, _ = along(searching(2.0), lambda w: solution(w, width=KEPT_WIDTH))
    assert len(tried) == 1


@pytest.mark.parametrize(
    ("share", "count"), [(0.985, 2), (0.995, 1), (0.495, 4), (0.498, 3)]
)
def test_a_window_takes_what_would_be_left_of_the_path_as_well(share, count):
    """That is a hundredth of a window at most."""
    tried, _ = along(searching(15.0 / share), solution)
    assert len(tried) == count


@pytest.mark.parametrize(("length", "count"), [(0.8, 5), (0.79, 4), (0.09, 1)])
def test_the_shortest_window_is_a_twentieth_of_a_stroke(length, count):
    search, tried = searching(length), []
    search.solve = lambda window, stages: tried.append(window)
    with pytest.raises(BoundError, match="no plan was found along the path"):
        search._along(())
    assert len(tried) == count


def soft(name, relaxed=True):
    return Inequality(name, lambda stage, state: [], relaxed=relaxed)


NAMED = soft("clearance"), soft("load", relaxed=False), soft("room")


@pytest.mark.parametrize(
    ("inequalities", "without", "refusal"),
    [
        ((), False, "0% of it; take a path that the joint ranges allow"),
        (NAMED, True, "0% of it; take a path that the joint ranges allow"),
        (NAMED, False, "0% of it; ask for less clearance and room"),
    ],
)
def test_where_no_plan_is_found_the_refusal_says_what_to_change(
    inequalities, without, refusal
):
    search = searching(1.0, inequalities)
    search.without_soft = without
    text = f"no plan was found along the path, whatever its tolerances, at {refusal}"
    assert str(search._refusal(WHOLE, None)) == text


@pytest.mark.parametrize(
    ("inequalities", "without", "width", "told"),
    [
        ((), False, 1.5, "0.06 and 0.15"),
        (NAMED, True, 1.5, "0.06 and 0.15"),
        (
            NAMED,
            False,
            1.5 / CHECKED_SHARE,  # which was divided by it
            "0.06 and 0.15, and its clearance and room may lack 0.251",
        ),
    ],
)
def test_a_refusal_says_which_tolerances_are_kept(inequalities, without, width, told):
    search = searching(1.0, inequalities)
    search.without_soft = without
    text = str(search._refusal(LATER, solution(LATER, width=width)))
    asked = "no plan was found within 0.04 and 0.1 of the path at 20% of it"
    assert text == f"{asked}; the nearest found there keeps {told}"


def test_plans_of_a_single_window_are_kept_for_all_tolerances():
    plans = [solution(WHOLE), solution(WHOLE)]
    for length in (1.0, 30.0):
        search = searching(length)
        search.solve = lambda window, count: solution(window)
        search.fitted = lambda window, rungs: plans
        done = search._along(("finer",))
        if len(done) == 1:
            assert done[0] is plans[1]
            assert search.found == [(search.task, plans[0]), ("finer", plans[1])]
        else:
            assert search.found == []


def test_larger_tolerances_can_do_without_the_time_that_is_left():
    search = searching(1.0)
    found = solution(WHOLE)

    def over(window, rungs):
        raise BudgetError(1.0, "")

    search.solve, search.fitted = lambda window, count: found, over
    assert search._along(()) == [found]


def test_a_path_that_is_refused_for_rounded_tolerances_is_tried_for_its_own():
    search = searching(1.0, rungs=("finer",))
    calls, own = [], solution(WHOLE)

    def tried(self, rungs):
        calls.append((self is search, rungs))
        if self is not search:
            raise BoundError("refused")
        return [own]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Search, "_along", tried)
        assert search.run() == [own]
    assert calls == [(False, ("finer",)), (True, ())]


@pytest.mark.parametrize(
    ("widths", "found"),
    [
        ((1.0,), 0),
        ((KEPT_WIDTH,), 0),
        ((None, 1.0), 1),
        ((1.1, 1.0), 1),
        ((2, 2), None),
    ],
)
def test_a_solution_is_made_again_from_near_and_then_from_afar(widths, found):
    search, given = searching(1.0), solution(LATER, count=3)
    solutions = [w and solution(LATER, width=w) for w in widths]
    asked, margins = [], Margins(np.ones(3), np.zeros((3, 0)))

    class Programs(Solved):
        def solve(self, guess, ends, goal, margins, near):
            asked.append((guess, ends, goal, margins))
            return super().solve(guess, ends, goal, near)

    search.programs = Programs(*solutions)
    again = search.again(given, WHOLE.goal, margins)
    assert again is (None if found is None else solutions[found])
    assert search.programs.asked == [(3, 3)]
    assert search.programs.near == [True, False][: len(widths)]
    assert asked == [(given, (0.2, pytest.approx(0.6)), WHOLE.goal, margins)] * len(
        widths
    )
