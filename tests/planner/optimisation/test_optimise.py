"""Optimised plans meet their goals, keep to their paths, and are short."""

import sys
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BoundError, BudgetError, StratumError
from planner.optimisation import (
    constraints,
    program,
    search,
    windows,
)
from planner.optimisation.constraints import Margins
from planner.optimisation.corridor import Tolerance, deviation
from planner.optimisation.refinement import Violations
from planner.optimisation.solver import MissingSolverError
from planner.optimisation.stages import Stage, cycle
from planner.optimisation.task import Inequality
from planner.optimisation.windows import WindowSearch
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import play, rollout
from planner.support.stopping import limited
from planner.systems.fields import NumericField
from planner.systems.strata import StratifiedSystem
from tests.planner.optimisation.step import (
    BIPED,
    EXTENDED,
    POINTS,
    POINTS_ALONG,
    POSITION,
    SPAN,
    STEP,
    YAW,
    optimised,
    time_of,
)


@pytest.fixture(scope="module")
def optimiser():
    return optimised()


@pytest.fixture(scope="module")
def found(optimiser):
    return optimiser.plan()


def test_the_goal_is_met_and_legs_are_back(found):
    assert rollout(found)[-1] == pytest.approx(STEP(1.0), abs=1e-6)


def test_the_motion_stays_within_its_tolerances(found):
    position, yaw = deviation(rollout(found, 20), POINTS, [(0, 1), (2,)])
    assert position <= POSITION
    assert yaw <= YAW


def test_legs_stay_within_their_range(found):
    assert np.abs(rollout(found)[:, 3:5]).max() <= SPAN + 1e-9


def test_it_is_shorter_than_the_stratified_plan(found):
    stratified = plan(EXTENDED, STEP, 4)
    assert time_of(found.flows) < 0.6 * time_of(stratified.flows)  # 0.5 measured
    assert found.contact_switches < stratified.contact_switches


def test_another_goal_nearby_takes_the_same_strokes(optimiser, found):
    goal = STEP(1.0) + [0.01, -0.02, 0.03, 0, 0, 0, 0]
    aside = optimiser.plan(goal)
    assert rollout(aside)[-1] == pytest.approx(goal, abs=1e-6)
    assert [f.field for f in aside.flows] == [f.field for f in found.flows]


def test_fewest_switches_are_no_more_than_those_of_the_fastest(found):
    fewest = optimised(objective="switches").plan()
    assert fewest.contact_switches <= found.contact_switches


def test_long_paths_are_cut_and_still_end_in_their_goal(monkeypatch):
    monkeypatch.setattr(search, "FIRST_WINDOW", 2.0)
    monkeypatch.setattr(search, "MANY", 8)
    monkeypatch.setattr(windows, "MOST_STAGES", 8)
    monkeypatch.setattr(windows, "CLOSELY", 1)
    goal = np.array([4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    optimiser = optimised(line(np.zeros(7), goal))
    found = optimiser.plan()
    assert len(optimiser._solutions) > 1
    assert rollout(found)[-1] == pytest.approx(goal, abs=1e-6)


def test_the_plans_that_are_solved_again_are_the_best_and_none_of_them_twice():
    plans = [1.3, 1.0, 1.0 + 1e-7, 1.2, 1.1, 1.1 + 1e-7, 1.4]
    search = SimpleNamespace(_kept_plans=plans, score=float)
    assert WindowSearch._finalists(search) == [1.0, 1.1, 1.2, 1.3]


def test_stages_go_on_where_the_window_before_ended(monkeypatch):
    """Also where the first window begins with another stage than the cycle does."""
    for name, value in (("FIRST_WINDOW", 2.0), ("MANY", 8)):
        monkeypatch.setattr(search, name, value)
    for name, value in (("MOST_STAGES", 8), ("CLOSELY", 1)):
        monkeypatch.setattr(windows, name, value)
    optimiser = optimised(line(np.zeros(7), [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    optimiser._search.score = lambda solution: -solution.first
    solutions, cycle_length = optimiser._solutions, len(optimiser.task.stages)
    assert len(solutions) > 1
    assert solutions[0].first == 1
    for before, after in pairwise(solutions):
        assert after.first == (before.first + len(before.strokes)) % cycle_length


def test_violations_between_the_checks_are_mended_in_every_window(monkeypatch):
    for module in (program, constraints):  # so that nothing is kept in reserve
        monkeypatch.setattr(module, "CHECKED_SHARE", 1.0)
    for name, value in (("FIRST_WINDOW", 1.0), ("MANY", 8)):
        monkeypatch.setattr(search, name, value)
    monkeypatch.setattr(windows, "CLOSELY", 1)
    path = line(np.zeros(7), [2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    most, groups = np.array([0.3, 0.5]), [(0, 1), (2,)]
    tight = (Tolerance((0, 1), most[0]), Tolerance((2,), most[1]))
    optimiser, points = optimised(path, tolerances=tight), path.at(POINTS_ALONG)
    assert len(optimiser._solutions) > 1
    raw = [flow for part in optimiser.flows(optimiser._solutions) for flow in part]
    states = play(BIPED.system, raw, path(0.0), 8)
    assert (deviation(states, points, groups) / most).max() > 1 + 5e-6  # 1.2e-5
    states = rollout(optimiser.plan(), 8)
    assert (deviation(states, points, groups) / most).max() <= 1.0


def test_larger_margins_move_the_stages_of_one_window_between_its_ends(found):
    optimiser = optimised()
    (solution,) = optimiser._solutions
    none = Margins.none(optimiser.task, len(solution.strokes))
    violations = Violations(1.1, np.zeros(0))
    (asked,) = optimiser._refinement.enlarged([none], [solution], violations)
    assert (asked.shares < 1.0).any()
    again = optimiser._search.again(solution, solution.states[-1], asked)
    assert again.states[-1] == pytest.approx(solution.states[-1], abs=1e-9)
    for k in np.flatnonzero(asked.shares < 1.0)[:-1]:
        off = np.linalg.norm((again.states[k + 1] - STEP(again.places[k + 1]))[:2])
        assert off <= asked.shares[k] * POSITION


def test_stages_that_exceed_nothing_are_asked_for_nothing_more(monkeypatch):
    optimiser = optimised()
    (solution,) = optimiser._solutions
    none = Margins.none(optimiser.task, len(solution.strokes))
    widths = np.full(len(solution.strokes), 0.9)
    widths[1] = 1.05
    monkeypatch.setattr(type(optimiser._refinement), "_widths", lambda *_: widths)
    violations = Violations(1.1, np.zeros(0))
    (one,) = optimiser._refinement.enlarged([none], [solution], violations)
    widths[1] = 0.9
    (every,) = optimiser._refinement.enlarged([none], [solution], violations)
    assert np.flatnonzero(one.shares < 1.0).tolist() == [1]
    assert one.shares[1] == pytest.approx(1 / (1.1 + 1e-3))
    assert (every.shares < 1.0).all()  # nobody knows where


def test_a_plan_that_misses_its_goal_by_far_is_none(monkeypatch):
    optimiser = optimised()
    optimiser._solutions  # noqa: B018, found before
    monkeypatch.setattr(type(optimiser._search), "again", lambda *_: None)
    goal = optimiser.path(1.0) + [0.05, 0, 0, 0, 0, 0, 0]
    with pytest.raises(BoundError, match="misses its goal by 0.0"):
        optimiser.plan(goal)


def test_what_was_found_in_time_is_made_exact_in_any_time(found):
    optimiser = optimised()
    optimiser._solutions  # noqa: B018, found before
    with limited(1e-9):
        plan = optimiser.plan()
    assert rollout(plan)[-1] == pytest.approx(rollout(found)[-1], abs=1e-6)


def test_tolerances_that_are_not_kept_are_refused_with_those_that_are(monkeypatch):
    monkeypatch.setattr(search, "MANY", 6)
    monkeypatch.setattr(windows, "MOST_STAGES", 6)
    tight = (Tolerance((0, 1), 0.01), Tolerance((2,), 0.02))
    with pytest.raises(BoundError, match="within 0.01 and 0.02 .* nearest"):
        optimised(tolerances=tight).plan()


def test_what_else_a_refused_plan_may_lack_is_named_by_its_task(monkeypatch):
    for name, value in (("MANY", 6), ("LAST_WINDOW", 0.2)):
        monkeypatch.setattr(search, name, value)
    for name, value in (("MOST_STAGES", 6), ("ROUGHLY", 1)):
        monkeypatch.setattr(windows, name, value)

    def never(stage, state):
        return [state[0] - 9.0]

    asked = (Inequality("distance from home", never, relaxed=True),)
    with pytest.raises(BoundError, match="and its distance from home may lack"):
        optimised(inequalities=asked).plan()


def test_inequalities_are_kept_as_stages_begin_and_end():
    def narrow(stage, state):
        return [0.3 - state[3], state[3] + 0.3]  # a leg's angle

    asked = (Inequality("room of a leg", narrow),)
    states = rollout(optimised(inequalities=asked).plan())
    assert np.abs(states[:, 3]).max() <= 0.3 + 1e-6
    assert np.abs(states[:, 4]).max() > 0.3


def stopped_by(error, monkeypatch, found):
    """Searches that are stopped before, or after, they have found a plan."""
    width = WindowSearch._width

    def until(self, window, count, attempts):
        if not found or self._best is not None:
            raise error
        return width(self, window, count, attempts)

    monkeypatch.setattr(WindowSearch, "_width", until)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), BudgetError(1.0, "")])
def test_a_search_that_is_stopped_ends_with_the_best_so_far(monkeypatch, error):
    stopped_by(error, monkeypatch, found=True)
    optimiser = optimised()
    assert rollout(optimiser.plan())[-1] == pytest.approx(STEP(1.0), abs=1e-6)
    assert optimiser.is_hurried


@pytest.mark.parametrize("error", [KeyboardInterrupt(), BudgetError(1.0, "")])
def test_a_stop_before_anything_is_found_is_passed_on(monkeypatch, error):
    stopped_by(error, monkeypatch, found=False)
    with pytest.raises(type(error)):
        optimised().plan()


def test_work_that_is_done_is_reported_as_it_grows():
    reported = []
    optimiser = optimised()
    optimiser._search.report = reported.append
    optimiser.plan()
    assert len(reported) > 5
    assert reported == sorted(reported)
    assert reported[-1] == 1.0
    assert not optimiser.is_hurried


def test_a_missing_solver_is_told_with_the_way_out(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingSolverError, match="scripts/setup installs all extras"):
        optimised().plan()


def test_fields_known_as_functions_are_refused():
    strata = {"0": {"f": NumericField(lambda x: [1, 0])}}
    system = StratifiedSystem(state=["x", "y"], strata=strata, bottom="0")
    with pytest.raises(StratumError, match="known as a function only"):
        cycle(system, ["f"])


def test_strokes_during_which_legs_recover_meet_the_goal_too():
    found = optimised(overlapped=True).plan()
    assert rollout(found)[-1] == pytest.approx(STEP(1.0), abs=1e-6)


def test_strokes_whose_legs_are_set_anew_leave_recoveries_to_others():
    found = optimised(centred=True).plan()
    assert {flow.field for flow in found.flows} <= {"g1_1", "g2_2"}


def test_functions_of_stages_are_built_once_for_all_tolerances(optimiser):
    tasks = optimiser.task, optimiser.task.rounded
    given = optimiser.task.stages[0], STEP(0.0)
    assert len({id(constraints.stage_function(task, *given)) for task in tasks}) == 1


def test_margins_of_inequalities_are_for_states_that_are_free_to_move():
    """A first stage begins and a last one ends where it must, whatever is asked for."""
    ca, unit = pytest.importorskip("casadi"), 2.0
    kept = Inequality("kept", lambda stage, state: [state[0]])
    task = SimpleNamespace(
        inequalities=(kept,), moved=(0,), overlapped=False, unit=lambda start: unit,
        built={},
    )  # fmt: skip
    states, asked = ca.SX.sym("states", 1, 3), np.array([[0.2], [0.4], [0.6]])
    rows = constraints.Constraints()
    rows.inequalities(
        task, Stage("0", None, ()), np.zeros(1), (states, states), states, range(3)
    )
    low, high = rows.bounds(Margins(np.ones(3), asked))
    tightened = np.repeat(asked, 3, axis=1)  # as a stage begins, has recovered and ends
    tightened[0, 0] = tightened[2, 2] = 0.0
    assert low.reshape(3, 3) == pytest.approx(tightened / unit)
    assert np.isinf(high).all()
