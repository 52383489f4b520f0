"""Decisions of a setup: what is shared, learnt, aimed at and written down."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner import PlannerError
from sim.errors import UsageError
from sim.feedback.filter import NONE_MISSED, Learnt
from sim.preparation.setup import prepare
from sim.preparation.shared import Shared, no_cache
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

LEAST_POSITION = 1e-3
LEAST_YAW = 1e-2
LEARNT = Learnt(np.zeros(3), np.zeros((3, 3)), np.eye(12)).numbers
ROUNDED = 1.0 + 1e-9  # times a tolerance, within which it is kept


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


def with_settings(setup, **changes):
    return replace(setup, scenario=replace(setup.scenario, **changes))


@pytest.mark.parametrize(
    ("changes", "shared"),
    [
        ({}, True), ({"steer": "quasi-static"}, False), ({"words": "shortest"}, False),
        ({"min_margin": 0.01}, False), ({"optimise": "time"}, False),
        ({"correct": 2}, False), ({"friction": 0.3}, True),
        ({"obstacles": (1,)}, False),
    ],
)  # fmt: skip
def test_plans_of_ideal_fields_and_the_path_alone_are_shared(setup, changes, shared):
    scenario = setup.scenario
    for name, value in changes.items():
        object.__setattr__(scenario := replace(scenario), name, value)
    assert replace(setup, scenario=scenario).is_shareable == shared
    counted = replace(setup, servo=replace(setup.servo, resolution=0.01))
    assert not counted.is_shareable


def test_what_follows_from_commands_is_made_once_for_equal_commands(setup):
    shared, made = Shared(), []

    def make():
        made.append(len(made))
        return made[-1]

    cache = setup.walk_cache(shared)
    assert [cache("kind", make), cache("kind", make)] == [0, 0]
    rough = with_settings(setup, friction=0.4).walk_cache(shared)
    assert rough("kind", make) == 0
    finer = with_settings(setup, sample_every=7).walk_cache(shared)
    assert finer("kind", make) == 1
    faster = replace(setup, scenario=replace(setup.scenario, swing_speed=1.5))
    assert faster.walk_cache(shared)("kind", make) == 2  # whatever its limits say
    assert cache("other", make) == 3
    assert setup.walk_cache(None) is no_cache
    assert with_settings(setup, replan=True).walk_cache(shared) is no_cache
    assert with_settings(setup, words="shortest").walk_cache(shared) is no_cache


@pytest.mark.parametrize(
    ("changes", "learns"),
    [
        ({"replan": False, "learn": True}, False),
        ({"replan": True}, False),
        ({"replan": True, "learn": True}, True),
        ({"replan": True, "sense": "tag"}, True),
        ({"replan": True, "sense": "tag", "learn": False}, False),
        ({"replan": True, "backlash": 0.01}, True),
        ({"replan": True, "learnt": LEARNT}, True),
    ],
)
def test_replanned_walks_learn_where_something_is_to_be_learnt(setup, changes, learns):
    made = with_settings(setup, **changes)
    assert made.learns == learns
    spread = np.diagonal(made.feedback().covariance)[3:6]
    assert (spread > 0).all() == learns
    assert (NONE_MISSED.bias == 0).all()


def test_what_no_walk_has_learnt_is_refused_with_what_to_give(setup):
    odd = (0.0,) * 12 + (-1.0,) * 78
    said = "^the covariance must be .*: learnt; give what a walk learnt$"
    with pytest.raises(UsageError, match=said):
        with_settings(setup, replan=True, learnt=odd).feedback()


def test_walks_aimed_beside_their_goal_go_there_evenly(setup):
    offset = (0.01, -0.02, 0.1)
    aimed = replace(setup, goal_offset=offset)
    plain, aside = setup.nominal(), aimed.nominal()
    for s in (0.0, 0.25, 1.0):
        apart = aside(s)[:3] - plain(s)[:3]
        assert apart == pytest.approx(s * np.array(offset))
        assert (aside(s)[3:] == 0).all()


def test_two_setups_are_equal_in_one_world(setup):
    other = with_settings(setup, segments=3)
    assert setup == other
    assert hash(setup) == hash(other)
    assert setup != prepare(load_scenario("line", {"friction": 0.4}))
    assert setup != "setup"


def test_a_path_is_divided_at_its_cuts(setup):
    made = setup.recut(np.array([0.0, 0.2, 1.0]))
    assert made.scenario.segments == 2
    goal = np.array(setup.scenario.path.goal)
    assert made.nominal()(0.5)[:3] == pytest.approx(0.2 * goal)


def test_settings_that_were_left_to_the_robot_are_written_down(setup):
    found = setup.resolved(setup.scenario, "mine")
    stiffness, damping = setup.world.servo
    assert (found.servo_stiffness, found.servo_damping) == (stiffness, damping)
    assert (found.robot, found.stance) == ("mine", "centred")
    given = replace(setup.scenario, servo_stiffness=3.0, servo_damping=0.1)
    kept = setup.resolved(given, "mine")
    assert (kept.servo_stiffness, kept.servo_damping) == (3.0, 0.1)


def test_legs_are_raised_where_a_stratum_does_not_stand_on_them(setup):
    lift = setup.limits.lift_angle
    for stratum, raised in setup.raised.items():
        assert raised.tolist() == [
            lift * (g not in stratum) for g in setup.robot.groups
        ]
    assert set(setup.raised) == set(setup.robot.card.gait)
    assert setup.at_rest.swing == (0.0, 0.0)
    assert setup.at_rest.stratum == setup.robot.card.bottom


@pytest.fixture
def planless(monkeypatch, setup):
    """A problem without a stratified plan."""

    def none(self):
        raise PlannerError("no plan")

    monkeypatch.setattr(ScenarioProblem, "stratified", property(none))
    return lambda **changes: ScenarioProblem(with_settings(setup, **changes))


def test_tolerances_without_a_plan_are_the_given_or_the_least_ones(planless):
    assert planless().within == (LEAST_POSITION, LEAST_YAW)
    some = planless(path_tolerance=0.02)
    assert some.within == (0.02, LEAST_YAW)
    assert planless(yaw_tolerance=0.3).within == (LEAST_POSITION, 0.3)
    assert not some.has_fallback
    assert some.least_time is None


@pytest.mark.parametrize(
    ("position", "yaw", "kept"),
    [
        (1.001, 1.001, True),
        (0.999, 1.001, False),
        (1.001, 0.999, False),
        (1.0, 1.0, True),
    ],
)
def test_a_plan_is_a_fallback_within_both_tolerances(setup, position, yaw, kept):
    own = ScenarioProblem(setup)._own_deviation
    changes = {
        "path_tolerance": position * own.position,
        "yaw_tolerance": yaw * own.yaw,
    }
    assert ScenarioProblem(with_settings(setup, **changes)).has_fallback == kept
    assert ROUNDED > 1


@pytest.mark.parametrize(
    ("pose", "off"),
    [
        ((0.3, 0.4, 0.5), 0.0),
        ((0.3, 0.4, 0.7), 0.2 * 0.2),
        ((0.3, 0.4, 0.5 - 2 * np.pi - 0.1), 0.2 * 0.1),
        ((0.0, 0.0, 0.6), 0.5),
    ],
)
@pytest.mark.parametrize(("length", "turned"), [(2.0, 0.5), (0.0, -1.5), (0.0, 0.0)])
def test_what_a_pose_misses_is_a_share_of_the_way_of_the_body_or_its_feet(
    pose, off, length, turned
):
    """Feet reach 0.2 m, so that they go 0.2 m for each radian of the body."""
    from sim.problems.scenario import miss_of

    fake = SimpleNamespace(
        kinematics=SimpleNamespace(reach=0.2),
        scenario=SimpleNamespace(path=SimpleNamespace(length=length)),
        nominal=lambda: lambda s: np.array([0.0, 0.0, turned * s]),
    )
    way = max(length, 0.2 * abs(turned))
    found = miss_of(fake, np.array(pose), np.array([0.3, 0.4, 0.5]))
    assert found == pytest.approx(off / way if way else 0.0, abs=1e-12)


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_a_part_of_the_way_is_planned_and_missed_by_its_own_share(setup, share):
    """What is missed is weighed by the way to the end of the part."""
    from planner import play
    from sim.problems.scenario import miss_of

    short = prepare(
        load_scenario("line", {"path.goal": [0.04, 0.02, 0.0], "segments": 4})
    )
    problem = ScenarioProblem(short)
    goal = np.array(short.scenario.path.goal) * share
    part = prepare(load_scenario("line", {"path.goal": goal.tolist(), "segments": 4}))
    planned = ScenarioProblem(part).stratified
    end = play(planned.system, planned.flows, planned.start)[-1]
    best = miss_of(short, end[:3], goal) / share
    assert problem.attempt(share) == pytest.approx(best, rel=1e-6)
