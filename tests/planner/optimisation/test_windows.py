"""Which numbers of stages a search tries, and how often."""

import numpy as np
import pytest

from tests.planner.optimisation.stubs import LATER, WHOLE, Found, searching

KEPT_WIDTH = 1.0 + 1e-6  # of the corridor, in tolerances, that counts as keeping them
MOST_STAGES = 96  # of a window


def widths_by(search, width):
    """Let widths follow from numbers of stages; the trials, with their attempts."""
    tried = []

    def found(window, count, attempts):
        tried.append((count, attempts))
        if width(count) <= KEPT_WIDTH:
            search._best = Found(count=count)
        return width(count)

    search._width = found
    return tried


def enough(need, otherwise):
    return lambda count: 1.0 if count >= need else otherwise


@pytest.mark.parametrize(
    ("first", "otherwise", "tried"),
    [
        (10, 1.5, [10, 14, 20, 28, 39]),  # 0.8 times the excess more
        (20, 1.01, [20, 22, 24, 26, 29, 32, 35, 38]),  # a tenth more at least
        (3, 1.01, [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]),  # one more
        (3, 9.0, [3, 6, 12, 24, 48]),  # twice as many at most
        (38, KEPT_WIDTH, [38]),
    ],
)
def test_the_wider_a_corridor_is_needed_the_more_stages_are_tried(
    first, otherwise, tried
):
    search = searching()
    trials = widths_by(search, enough(tried[-1], otherwise))
    search.hurried = True  # so that none of them is tried in between
    assert search._fewest(WHOLE, 0, first) == tried[-1]
    assert [count for count, _ in trials] == tried


def test_where_no_motion_is_found_at_all_more_guesses_are_made():
    search = searching()
    trials = widths_by(search, enough(6, np.inf))
    search.hurried = True
    assert search._fewest(WHOLE, 0, 3) == 6
    assert [count for count, _ in trials] == [3, 3, 6]
    assert trials[0][1] < trials[1][1] > trials[2][1]


def test_a_window_has_a_largest_number_of_stages_and_it_is_tried():
    search = searching()
    trials = widths_by(search, lambda count: 2.0)
    assert search._fewest(WHOLE, 0, 50) == MOST_STAGES
    assert [count for count, _ in trials] == [50, 90, MOST_STAGES]


@pytest.mark.parametrize("first", [3, 10, 32])
def test_the_fewest_stages_are_found_to_a_tenth_and_exactly_if_they_are_few(first):
    for need in range(1, MOST_STAGES + 1):
        search = searching()
        widths_by(search, enough(need, 1.3))
        found = search._fewest(WHOLE, 0, first)
        assert need <= found <= (need if found < 20 else need + 0.1 * found)


@pytest.mark.parametrize(
    ("few", "first", "need", "tried"),
    [
        (0, 64, 33, [64, 32, 48, 40, 36, 34]),
        (0, 48, 50, [48, 53]),
        (9, 10, 5, [10]),
        (8, 10, 5, [10, 9]),
        (0, 10, 10, [10, 5, 7, 8, 9]),
    ],
)
def test_numbers_in_between_are_halved_until_they_are_close(few, first, need, tried):
    search = searching()
    trials = widths_by(search, enough(need, 1.01))
    search._fewest(WHOLE, few, first)
    assert [count for count, _ in trials] == tried


def parts(search):
    """What follows after the fewest stages are known, with their number."""
    calls = []
    search._improve = lambda window, count: calls.append(("improve", count))
    search._hop = lambda window: calls.append(("hop",))
    return calls


@pytest.mark.parametrize(
    ("window", "tried"), [(WHOLE, [12, 6, 3, 4, 5]), (LATER, [12, 11])]
)
def test_a_later_window_begins_near_the_number_of_the_one_before(window, tried):
    search = searching()
    trials, calls = widths_by(search, enough(5, 1.1)), parts(search)
    search._explore(window, 12)
    assert [count for count, _ in trials] == tried
    assert calls == [("improve", tried[-1]), ("hop",)]


def test_soft_constraints_are_searched_for_where_the_search_without_them_ended():
    search, states = searching(soft=True), []
    trials, calls = widths_by(search, enough(5, 1.1)), parts(search)
    known = search._width

    def width(window, count, attempts):
        states.append((search.without_soft, search._best is None))
        return known(window, count, attempts)

    search._width = width
    search._tried.add((5, 0, 0))
    search._explore(WHOLE, 10)
    assert [count for count, _ in trials] == [10, 5, 2, 3, 4, 5]
    assert states[-1] == (False, True)  # nothing counts that lacks them
    assert all(without for without, _ in states[:-1])
    assert calls == [("improve", 5)]
    assert not search._tried


@pytest.mark.parametrize("soft", [False, True])
def test_what_keeps_no_tolerances_is_not_improved(soft):
    search = searching(soft)
    widths_by(search, lambda count: 2.0)
    calls = parts(search)
    search._explore(WHOLE, 10)
    assert calls == []


def scored_by(search, score):
    """Let scores follow from numbers of stages; the numbers that are tried."""
    tried = []

    def width(window, count, attempts):
        tried.append((count, attempts))
        found = Found(cost=score(count), count=count)
        search._best = min(search._best or found, found, key=search.score)
        return 1.0

    search._width = width
    return tried


def test_more_stages_are_tried_until_two_numbers_bring_no_progress():
    scores = {10: 10.0, 11: 9.0, 12: 8.995, 13: 8.9, 14: 8.895, 15: 8.892, 16: 1.0}
    search = searching()
    trials = scored_by(search, scores.get)
    search._improve(WHOLE, 10)  # progress is a thousandth of the score
    assert [count for count, _ in trials] == [10, 11, 12, 13, 14, 15]
    assert {attempts for _, attempts in trials} == {5}  # at each


@pytest.mark.parametrize(
    ("first", "tried"),
    [(3, [3, 4, 5, 6]), (70, [70, 77, 85, 94]), (96, [96]), (97, [])],
)
def test_numbers_that_are_tried_grow_by_a_tenth_or_one(first, tried):
    search = searching()
    trials = scored_by(search, lambda count: 1.0 / count)
    search._improve(WHOLE, first)
    assert [count for count, _ in trials][: len(tried)] == tried
    assert max([0, *(count for count, _ in trials)]) <= MOST_STAGES


def test_who_is_in_a_hurry_improves_nothing():
    search = searching(hops=3)
    trials = scored_by(search, lambda count: 1.0 / count)
    search.hurried, search._best = True, Found()
    search._improve(WHOLE, 5)
    search._hop(WHOLE)
    assert trials == search.reported == []


def trials_of(search, window, count, attempts, width=2.0):
    """The first stages and the numbers of guesses of all trials, and their result."""
    made = []

    def solved(window, trial, strokes):
        assert len(strokes) == trial[0] == count
        made.append(trial[1:])
        return None if width is None else Found(width=width + 0.1 * len(made))

    search._solved = solved
    return search._width(window, count, attempts), made


@pytest.mark.parametrize(
    ("soft", "window", "count", "attempts", "made"),
    [
        (False, WHOLE, 20, 2, [(0, 0), (0, 1), (1, 0), (1, 1)]),
        (False, WHOLE, 21, 2, [(0, 0), (0, 1)]),
        (False, LATER, 4, 2, [(3, 0), (3, 1)]),
        (False, WHOLE, 21, 5, [(0, 0), (0, 1), (0, 2)]),
        (True, WHOLE, 21, 5, [(0, 0), (0, 1), (1, 0), (1, 1)]),
        (True, WHOLE, 21, 2, [(0, 0), (1, 0)]),
        (True, WHOLE, 21, 1, [(0, 0), (1, 0)]),
        (True, WHOLE, 21, 9, [(0, 0), (0, 1), (1, 0), (1, 1)]),
        (True, LATER, 4, 2, [(3, 0)]),
    ],
)
def test_the_first_stage_is_free_where_the_path_begins(
    soft, window, count, attempts, made
):
    """Of many stages only with soft constraints, which fewer guesses are made for."""
    search = searching(soft)
    search.without_soft = False
    least, found = trials_of(search, window, count, attempts)
    assert found == made
    assert least == pytest.approx(2.1)
    again = trials_of(search, window, count, attempts)
    assert again == (np.inf, [])  # no trial is made twice


def test_a_number_of_stages_without_a_motion_needs_an_endless_width():
    assert trials_of(searching(), LATER, 4, 2, width=None)[0] == np.inf


def test_who_is_in_a_hurry_takes_the_first_that_is_kept():
    search = searching()
    search.hurried = True
    assert trials_of(search, WHOLE, 4, 2, width=0.9) == (1.0, [(0, 0)])
    assert len(trials_of(search, WHOLE, 5, 2, width=1.0)[1]) == 4


@pytest.mark.parametrize(
    ("soft", "hops", "most"), [(False, 0, 1.0), (False, 5, 0.3), (True, 5, 1.0)]
)
def test_each_trial_does_a_part_of_the_work_that_precedes_the_hops(soft, hops, most):
    search = searching(soft, hops=hops)
    trials_of(search, WHOLE, 10, 3)
    left = 0.97 ** np.arange(1, 7)
    assert search.reported == pytest.approx(most * (1.0 - left))
