"""With how many stages searches begin, and to what tolerances are rounded."""

import numpy as np
import pytest

from planner.optimisation.search import _first_count
from planner.optimisation.stages import Stage, guesses
from planner.optimisation.task import Inequality, Task
from planner.optimisation.windows import WindowSearch
from tests.planner.optimisation.step import optimised, within
from tests.planner.optimisation.stubs import Found, searching


@pytest.mark.parametrize(
    ("length", "count"), [(0.1, 3), (0.45, 4), (1.0, 10), (3.15, 31), (8.0, 32)]
)
def test_a_search_begins_with_ten_stages_a_stroke_but_with_3_to_32(length, count):
    assert _first_count(length) == count


def test_tolerances_are_rounded_down_to_sixteen_a_decade():
    for steps in (-3.0, -2.95, -2.01):
        task = optimised(tolerances=within(10 ** (steps / 16))).task
        assert task.rounded.tolerances[0].most == pytest.approx(10 ** (-3 / 16))
    assert task.rounded.tolerances[1] == task.tolerances[1]


def test_plans_are_solved_again_for_sixteen_times_as_many_tolerances():
    task = optimised(tolerances=within(10 ** (-2.01 / 16))).task
    most = np.array([rung.tolerances[0].most for rung in task.rungs])
    assert len(most) == 15  # between -3 and -2 sixteenths, both left out
    assert np.diff(np.log10(most)) == pytest.approx(np.full(14, 1 / 256))
    assert most[-1] <= task.tolerances[0].most


def test_a_tolerance_that_is_round_stays_in_spite_of_its_logarithm():
    task = optimised(tolerances=within(0.1)).task
    assert task.rounded.tolerances[0].most == pytest.approx(0.1)
    assert task.rungs == ()


def test_constraints_are_hard_and_legs_wait_unless_that_is_said():
    task = Task(optimised().task.system, (Stage("12", "", ()),), within(0.1))
    assert not task.overlapped
    assert not task.centred
    assert not Inequality("margin", lambda stage, state: []).relaxed


def test_the_four_best_plans_of_different_scores_are_solved_again():
    """Scores are alike that differ by a hundred-thousandth."""
    search = searching()
    costs = [1.0, 1.0 + 0.9e-5, 1.0 + 1.1e-5, 4.0, 2.0, 3.0]
    search._kept_plans.extend(Found(cost) for cost in costs)
    assert [plan.cost for plan in search._finalists()] == [1.0, 1.0 + 1.1e-5, 2.0, 3.0]


def test_soft_constraints_are_kept_and_searches_take_their_time_at_first():
    search = WindowSearch(searching().task, None, None)
    assert not search.without_soft
    assert not search.hurried
    assert search.hops == 0


def test_coarse_plans_fill_the_stages_or_half_of_them():
    asked = []

    def coarse(begin, end, segments):
        asked.append(segments)
        return ()

    stages = (Stage("12", "f", ()), Stage("12", "g", ())) * 2
    assert len([*guesses(stages, 41, (0.0, 1.0), coarse)]) >= 3
    assert asked == [5, 2]  # with a word of twice the cycle in each segment
