"""Scenarios that ask for short walks get them, within what else they ask for."""

from dataclasses import replace

import numpy as np
import pytest

from planner.errors import BoundError, BudgetError
from planner.planning.rollouts import play
from planner.support.stopping import limited
from sim.errors import UsageError
from sim.motion.poses import path_deviation
from sim.motion.prediction import inspections
from sim.motion.stability import stability_margin
from sim.optimisation.judging import Judge, margins
from sim.planning.open_loop import plan_open_loop
from sim.planning.soundness import require_sound
from sim.preparation.setup import prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

LEAST_POSITION = 1e-3
LEAST_YAW = 1e-2

SHORT = {
    "path.goal": [0.03, 0.03, 0.0],
    "segments": 6,
    "path_tolerance": 0.02,
    "yaw_tolerance": 3.2,
    "optimise": "time",
    "hops": 2,
    "overlap_recovery": True,
}


def setup_of(**changes):
    return prepare(load_scenario("line", SHORT | changes))


@pytest.fixture(scope="module")
def setup():
    return setup_of()


@pytest.fixture(scope="module")
def walk(setup):
    return ScenarioProblem(setup)


@pytest.fixture(scope="module")
def chosen(walk):
    return walk.solve()


@pytest.fixture(scope="module")
def found(chosen):
    return chosen.plan


def test_the_prediction_ends_in_the_goal_with_legs_at_rest(setup, found):
    goal = [0.03, 0.03, 0.0, 0.0, 0.0]
    assert Judge(setup).end(found.flows)[:5] == pytest.approx(goal, abs=1e-6)


def test_no_flows_end_where_they_begin(setup):
    judge = Judge(setup)
    states = len(judge.end(plan_open_loop(setup).flows))
    assert judge.end([]).tolist() == [0.0] * states


def test_it_is_several_times_faster_than_the_stratified_plan(setup, found):
    judge, stratified = Judge(setup), plan_open_loop(setup)
    assert judge.duration(found.flows) < judge.duration(stratified.flows) / 3


def test_it_stays_within_the_tolerance(setup, found):
    poses = Judge(setup).poses(found)
    assert path_deviation(setup.scenario.path.curve, poses).position <= 0.02


def test_segments_stay_those_of_the_scenario(setup, found):
    assert len(found.segment_ends) == 6
    assert found.start.shape == found.goal.shape


def test_where_no_tolerance_is_given_the_stratified_plan_s_deviation_is_allowed():
    free = ScenarioProblem(setup_of(path_tolerance=None, yaw_tolerance=None))
    planned = plan_open_loop(free.setup)
    poses = play(planned.system, planned.flows, planned.start, 50)[:, :3]
    own = path_deviation(free.setup.scenario.path.curve, poses)
    assert own.position > LEAST_POSITION
    assert own.yaw > LEAST_YAW
    assert free.within == pytest.approx((own.position, own.yaw), rel=0.02)  # sampling


def test_where_there_is_no_stratified_plan_the_least_tolerance_stands(monkeypatch):
    monkeypatch.setattr(ScenarioProblem, "_own_deviation", None)
    free = ScenarioProblem(setup_of(path_tolerance=None, yaw_tolerance=None))
    assert free.within == (LEAST_POSITION, LEAST_YAW)


def test_a_plan_beside_the_goal_ends_there(setup, walk):
    offset = (0.001, -0.002, 0.004)
    end = Judge(setup).end(walk.beside(offset).solve().plan.flows)
    assert end[:3] == pytest.approx(np.array([0.03, 0.03, 0.0]) + offset, abs=1e-6)


def test_margins_as_expressions_are_those_of_the_prediction(setup):
    stage = Judge(setup)
    planned = plan_open_loop(setup)
    schedule = stage.schedule(list(planned.segments()))
    rows = inspections(schedule) - 1
    swing, _ = schedule.angles(rows)
    least = margins(setup, 0.0)
    for stratum in ("1", "2"):
        on = [schedule.phases[k].stratum == stratum for k in schedule.phase_of(rows)]
        angles = swing[np.array(on)][5]
        on_stage = type("Stage", (), {"stratum": stratum})
        found = min(least(on_stage, [0.0, 0.0, 0.0, *angles]))
        raised = setup.raised[stratum]
        stance = setup.kinematics.stance(angles[None], raised[None])
        contact = setup.robot.planted(stratum)[None]
        expected = stability_margin(stance.feet, contact, stance.center_of_mass)[0]
        assert found == pytest.approx(expected, abs=1e-9)


def test_a_least_margin_is_kept(monkeypatch):
    for name in ("ANY_FIRST", "CLOSELY", "PATIENT_FOR", "FINALISTS", "ROUGHLY"):
        monkeypatch.setattr(f"planner.optimisation.windows.{name}", 1)
    near = {"path.goal": [0.005, 0.005, 0.0], "segments": 1, "hops": 0}
    setup = setup_of(**near, overlap_recovery=False, min_margin=0.045)
    found = ScenarioProblem(setup).solve().plan
    assert Judge(setup).margin_lack(list(found.segments())) == 0.0


def test_a_tolerance_that_cannot_be_kept_is_refused(monkeypatch):
    monkeypatch.setattr("planner.optimisation.search.MANY", 6)
    monkeypatch.setattr("planner.optimisation.windows.MOST_STAGES", 6)
    setup = setup_of(path_tolerance=0.0005, yaw_tolerance=0.005)
    with pytest.raises(BoundError, match="nearest found there keeps"):
        ScenarioProblem(setup).solve()


WIDE = 10.0  # [m], more than any of these walks strays


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (BoundError("no plan was found"), "no plan was found"),
        (BudgetError(1.0, ""), "none within 1 s"),
    ],
)
def test_a_plan_that_falls_back_says_why(monkeypatch, error, reason):
    def refused(self, goal=None):
        raise error

    monkeypatch.setattr("planner.optimisation.optimise.Optimiser.plan", refused)
    setup = setup_of(path_tolerance=WIDE)
    chosen = ScenarioProblem(setup).solve()
    assert chosen.fallback.startswith(reason)
    assert chosen.plan.flows == plan_open_loop(setup).flows


def test_what_a_search_ends_with_is_looked_at_when_its_time_is_over(setup):
    planned = plan_open_loop(setup)
    with limited(1e-9):
        require_sound(setup, planned)
    stratified = replace(setup, scenario=replace(setup.scenario, optimise="none"))
    with pytest.raises(BudgetError), limited(1e-9):
        require_sound(stratified, planned)


def test_a_plan_that_was_asked_for_does_not_say_that_it_falls_back(chosen):
    assert chosen.fallback is None


def test_optimising_and_replanning_exclude_each_other():
    with pytest.raises(UsageError, match="leave one of them out"):
        load_scenario("line", {"optimise": "time", "replan": True})
