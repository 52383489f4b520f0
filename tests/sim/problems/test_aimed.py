"""Optimised plans are aimed beside the goal until they are foreseen to end at it.

The optimiser and the compliant prediction take seconds; here a plan is where it was
aimed at, and what is foreseen of it a function of that.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import ConvergenceError, RangeError
from sim.preparation.setup import prepare
from sim.problems import scenario as library
from sim.problems.problem import Problem
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

AIMS = 4  # plans that are aimed; each misses a tenth of what the one before does
HIT = 1e-5  # [m] and [rad] that a plan may be foreseen to miss

GOAL = np.array([0.03, 0.03, 3.1])
WRONG = np.array([1e-3, -2e-3, 0.1])  # by which a plan misses that is not aimed beside


@pytest.fixture(scope="module")
def setup():
    given = {"path.goal": GOAL.tolist(), "optimise": "time", "steer": "compliant"}
    return prepare(load_scenario("line", given | {"segments": 2}))


@pytest.fixture
def aimed(setup, monkeypatch):
    """Solve it, where the end follows the offset by a factor; gives offsets tried."""
    problem, tried = ScenarioProblem(setup), []

    def solve(factor, reached=np.inf):
        def plan(beside):
            if np.abs(beside.setup.goal_offset).max() > reached:
                raise RangeError("too far", 0.7, -0.5, 0.5)
            tried.append(beside.setup.goal_offset)
            return SimpleNamespace(plan=np.array(beside.setup.goal_offset))

        def end(setup, plan):
            far = problem.path(1.0)[:3] + WRONG + factor * plan
            far[2] = (far[2] + np.pi) % (2 * np.pi) - np.pi  # as poses are told
            return far

        monkeypatch.setattr(Problem, "solve", plan)
        vars(problem)["_ahead"] = SimpleNamespace(end=end)
        return problem.solve().plan, tried

    return solve


def test_it_is_aimed_again_by_what_the_last_plan_is_foreseen_to_miss(aimed):
    found, tried = aimed(0.9)
    assert len(tried) == AIMS
    for k, (offset, after) in enumerate(zip(tried, tried[1:], strict=False)):
        assert np.subtract(offset, after) == pytest.approx(0.1**k * WRONG)
    assert np.abs(WRONG + 0.9 * found).max() == pytest.approx(1e-4)  # 0.1 to the third


def test_it_is_aimed_no_further_once_it_hits(aimed):
    found, tried = aimed(1.0)
    assert len(tried) == 2
    assert np.abs(WRONG + found).max() < HIT


@pytest.mark.parametrize(("left", "plans"), [(0.99, 2), (1.01, 3)])
def test_a_plan_hits_that_misses_a_hundredth_of_a_millimetre_or_milliradian(
    aimed, left, plans
):
    _, tried = aimed(1.0 - left * HIT / np.abs(WRONG).max())
    assert len(tried) == plans


def test_of_plans_that_miss_ever_more_the_first_is_taken(aimed):
    found, tried = aimed(3.0)
    assert len(tried) == AIMS
    assert found.tolist() == [0.0, 0.0, 0.0]


def test_where_legs_do_not_reach_beside_the_goal_the_least_miss_is_told(aimed):
    with pytest.raises(
        ConvergenceError, match="the plan still misses its end by 100 mm"
    ):
        aimed(0.9, 1e-3)


def test_where_legs_do_not_reach_the_goal_either_it_is_said(aimed):
    with pytest.raises(RangeError, match="too far"):
        aimed(0.9, -1.0)


def test_a_plan_out_of_range_is_told_with_the_least_that_others_missed(monkeypatch):
    """The first one was closer to the goal than the second."""
    misses = iter([0.02, 0.05, None])

    def solve(problem):
        miss = next(misses)
        if miss is None:
            raise RangeError("phi_1", 0.5, -0.4, 0.4)
        return SimpleNamespace(plan=miss)

    monkeypatch.setattr(Problem, "solve", solve)
    monkeypatch.setattr(library, "unaimed", lambda setup, what, least: KeyError(least))
    beside = object.__new__(ScenarioProblem)
    object.__setattr__(beside, "setup", None)
    end = lambda setup, plan: np.array([plan, 0.0, 0.0])  # noqa: E731
    own = SimpleNamespace(
        setup=SimpleNamespace(goal_offset=(0.0, 0.0, 0.0)), path=lambda s: np.zeros(3),
        beside=lambda offset: beside,
        centre=SimpleNamespace(_ahead=SimpleNamespace(end=end)),
    )  # fmt: skip
    with pytest.raises(KeyError) as caught:
        ScenarioProblem._aimed(own)
    assert caught.value.args == (0.02,)


@pytest.mark.parametrize(
    ("share", "cuts"), [(0.5, [0, 0.25, 0.5]), (0.6, [0, 0.25, 0.5, 0.6]), (1.0, None)]
)
def test_a_part_of_a_path_has_the_corners_before_its_end(share, cuts, monkeypatch):
    """Where it ends there is none, though the whole path turns there."""
    kept = []

    def recut(path, at):
        kept.append(at.tolist())
        return path

    class Way:
        corners = (0.25, 0.5, 0.75)

        def __call__(self, s):
            return np.zeros(3)

    end = [np.array([0.0, 0.0, 0.0])]
    planned = SimpleNamespace(system=None, flows=())
    for name, stub in (
        ("recut", recut), ("plan_along", lambda *_: planned),
        ("play", lambda *_: end), ("miss_of", lambda *_: 0.3),
    ):  # fmt: skip
        monkeypatch.setattr(library, name, stub)
    own = SimpleNamespace(path=Way(), replan=False, setup=None, words="printed")
    assert ScenarioProblem.attempt(own, share) == pytest.approx(0.3 / share)
    assert kept == ([] if cuts is None else [pytest.approx(cuts)])
