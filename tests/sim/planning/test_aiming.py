"""Steering on a prediction, without physics."""

from dataclasses import replace

import numpy as np
import pytest

from models.motion.real_contacts import contact_fields
from planner.errors import ConvergenceError, PlannerError
from planner.planning.rollouts import rollout
from planner.systems.flows import Flow, merged_segments
from sim.experiments.identification import twist_model
from sim.motion.poses import compose, relative
from sim.planning import open_loop
from sim.planning.open_loop import (
    plan_open_loop,
    plan_segment,
    segment_ends,
    steer_along,
    steer_towards,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module")
def turning():
    goal = {"kind": "line", "goal": [0.05, 0.05, 0.5]}
    return prepare(load_scenario("line", {"path": goal, "segments": 10}))


def aimed(setup, twists):
    """The last of the plans, aimed fully."""
    return list(steer_along(setup, twists))[-1]


@pytest.mark.parametrize("steer_on", ["ideal", "quasi-static"])
def test_segments_too_few_to_meet_the_corners_are_refused(steer_on):
    path = {"kind": "waypoints", "points": [[0, 0, 0], [0.05, 0, 0], [0.05, 0.05, 0]]}
    given = {"path": path, "segments": 1, "steer": steer_on}
    setup = prepare(load_scenario("line", given))
    rest = np.zeros(3), (0.0, 0.0)
    for make in (plan_open_loop, lambda setup: plan_segment(setup, 0, *rest)):
        with pytest.raises(PlannerError, match="cuts corners .*; plan at least 2 segm"):
            make(setup)


def test_predicted_ends_of_segments_lie_on_the_nominal_path(turning):
    twists = twist_model(turning, "quasi_static")
    ends = segment_ends(turning, aimed(turning, twists), twists)
    nominal = [turning.scenario.path(k / 10) for k in range(11)]
    # the rounds stop at 1e-7
    assert ends == pytest.approx(np.array(nominal), abs=1e-6)


def test_a_rough_plan_is_told_before_its_ends_are_predicted(turning, monkeypatch):
    predicted, predict = [], open_loop.segment_ends

    def counted(*given):
        predicted.append(predict(*given))
        return predicted[-1]

    monkeypatch.setattr(open_loop, "segment_ends", counted)
    next(steer_along(turning, twist_model(turning, "quasi_static")))
    assert len(predicted) == 3 - 1


def test_without_steering_the_prediction_misses_them(turning):
    ends = segment_ends(
        turning, plan_open_loop(turning), twist_model(turning, "quasi_static")
    )
    assert np.hypot(*(ends[-1] - turning.scenario.path(1.0))[:2]) > 1e-4


def test_the_ideal_ends_are_those_of_the_exact_kinematics(turning):
    planned = plan_open_loop(turning)
    ends = segment_ends(turning, planned, twist_model(turning, "ideal"))
    assert ends[-1] == pytest.approx(rollout(planned)[-1][:3], abs=1e-9)


@pytest.mark.parametrize("steer_on", ["ideal", "quasi-static"])
def test_shortest_words_meet_every_segments_end_on_less_travel(turning, steer_on):
    setup = prepare(replace(turning.scenario, words="shortest", steer=steer_on))
    planned = plan_open_loop(setup)
    twists = twist_model(setup, steer_on.replace("-", "_"))
    ends = segment_ends(setup, planned, twists)
    nominal = [turning.scenario.path(k / 10) for k in range(11)]
    assert ends == pytest.approx(np.array(nominal), abs=1e-6)
    assert swing_travel(planned) < swing_travel(plan_open_loop(turning))


def swing_travel(planned):
    loaded = merged_segments(planned.segments())
    return sum(
        abs(flow.duration) for _, flow in loaded if flow.field in ("g1_1", "g2_2")
    )


def test_a_segment_in_shortest_words_ends_at_its_target(turning):
    setup = prepare(replace(turning.scenario, words="shortest"))
    pose, swing = np.array([0.004, 0.006, 0.02]), (0.05, -0.1)
    end = rollout(plan_segment(setup, 0, pose, swing).plan)[-1]
    # the rounds stop at 1e-7
    assert end[:3] == pytest.approx(turning.scenario.path(0.1), abs=1e-6)


def test_a_walk_that_is_replanned_ends_with_its_legs_at_rest(turning):
    """Legs of a segment before it end where the next one wants them."""
    swing = (0.05, -0.1)
    *_, before, last = (
        rollout(
            plan_segment(
                turning, segment, turning.scenario.path(0.1 * segment), swing
            ).plan
        )[-1, 3:5]
        for segment in range(8, 10)
    )
    assert np.abs(last).max() < 1e-12
    assert np.abs(before).max() > 0.01


def test_a_segment_is_steered_from_any_pose_and_leg_angles(turning):
    steered = prepare(load_scenario("line", {"steer": "quasi-static", "segments": 10}))
    pose, swing = np.array([0.014, 0.017, 0.02]), (0.05, -0.1)
    step = plan_segment(steered, 0, pose, swing)
    ends = segment_ends(steered, step.plan, twist_model(steered, "quasi_static"), swing)
    target = relative(pose, steered.scenario.path(0.1))
    assert ends[-1] == pytest.approx(target, abs=1e-6)


def test_a_prediction_that_cannot_be_met_is_refused(turning):
    def stuck(stratum, swing, rates):
        return np.zeros((len(swing), 3))

    with pytest.raises(ConvergenceError, match="segment 10 of 10 still misses its"):
        aimed(turning, stuck)


def test_steps_between_poses_compose():
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(2, 20, 3))
    assert compose(a, relative(a, b)) == pytest.approx(b)


def test_flows_of_one_field_join_across_segments_and_cancel():
    first = [Flow("1", "g1_1", 0.1), Flow("2", "g2_2", 0.2)]
    second = [Flow("2", "g2_2", -0.2), Flow("1", "g1_1", 0.3)]
    assert merged_segments([first, second]) == [(0, Flow("1", "g1_1", 0.4))]


def same_flows(one, other):
    assert [flow[:2] for flow in one] == [flow[:2] for flow in other]
    durations = np.array([[flow.duration for flow in flows] for flows in (one, other)])
    assert durations[0] == pytest.approx(durations[1], abs=1e-6)  # of 3e-9 m/rad


def test_fields_of_the_real_contacts_steer_as_the_contacts_themselves(turning):
    twists = twist_model(turning, "quasi_static")
    described, groups = turning.equations, turning.robot.groups
    found = contact_fields(described, groups, twists).values()

    def fields(stratum, swing, rates):
        on = [field for field in found if field.stratum == stratum]
        amounts = rates @ np.linalg.pinv(np.array([field.direction for field in on]))
        return sum(u[:, None] * f(swing) for u, f in zip(amounts.T, on, strict=True))

    on = aimed(turning, twists), aimed(turning, fields)
    same_flows(*(plan.flows for plan in on))
    here, there = np.zeros(3), np.array([0.005, 0.004, 0.05])
    steps = (
        steer_towards(turning, t, 0, there, here, (0.1, -0.1)) for t in (twists, fields)
    )
    same_flows(*(step.plan.flows for step in steps))
