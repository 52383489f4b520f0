"""A run has the compliant prediction beside the others, and what it alone foresees."""

import numpy as np
import pytest

from sim.errors import UsageError
from sim.evaluation.assessment import evaluate
from sim.scenarios.file import load_scenario
from sim.scenarios.predictions import known_of
from sim.simulation import simulate

SHORT = {"segments": 1, "path.goal": [0.01, 0.01, 0.0], "servo_stiffness": 50.0}
LEFT_OUT = ("identified", "creep_floor")
PLAIN = {**SHORT, "feed_forward": False}


def simulated(**changes):
    return simulate(load_scenario("line", PLAIN | changes), without=LEFT_OUT)


@pytest.fixture(scope="module")
def laden():
    return simulated(payload=(0.3, 0.02, 0.0, 0.03))


def test_it_is_far_closer_than_the_rigid_one_where_joints_give_way(laden):
    error = laden.summary.error
    assert error["compliant"].farthest < 0.05 * error["quasi_static"].farthest


def test_slip_of_lifting_and_landing_is_foreseen(laden):
    predicted, achieved = laden.summary.predicted["compliant"], laden.summary.achieved
    assert predicted.slip_transition == pytest.approx(achieved.slip_transition, rel=0.1)
    assert predicted.slip_swing + predicted.slip_transition == pytest.approx(
        predicted.slip
    )
    assert laden.summary.predicted["quasi_static"].slip_transition is None
    assert predicted.lets_go == {}
    assert "switch slip" in str(laden)


def test_the_body_leans_and_rests_as_in_the_physics(laden):
    found = laden.evaluation.predicted["compliant"]
    moments, walking = laden.walk.recording.moments, laden.evaluation.walking
    w, x, y, z = moments.qpos[walking, 3:7].T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x**2 + y**2))
    height, predicted_roll, _ = found.lean[walking].T
    assert np.std(predicted_roll - roll) < 0.05 * np.std(roll)
    assert np.abs(height - moments.qpos[walking, 2]).max() < 1e-4
    assert (found.standing[walking] == moments.contact[walking]).mean() > 0.99
    weight = found.load[walking].sum(axis=1)
    assert np.median(weight) == pytest.approx(found.weight, rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"payload": (0.1, 0.0, 0.0, 0.0)}, ("payload",)),
        ({"zero_offset": 0.01}, ()),
        ({"zero_offset": (0.01,) * 12}, ("zero_offset",)),
        ({"zero_offset": 0.01, "known": "all"}, ("zero_offset",)),
        ({"payload": (0.1, 0.0, 0.0, 0.0), "known": "none"}, ()),
        ({"backlash": 0.01, "slope": (0.1, 0.0), "known": ["slope"]}, ("slope",)),
        ({"bumps": 0.001, "known": "all"}, ()),
    ],
)
def test_what_is_given_is_known_and_what_is_drawn_is_not(changes, told):
    scenario = load_scenario("line", changes)
    assert known_of(scenario) == told
    assert known_of(scenario.as_known) == told or scenario.known != "given"
    assert set(known_of(scenario.as_known)) <= set(told)


def test_a_hobby_robots_draw_stays_hidden_when_it_is_walked_again(hexapod):
    from sim.scenarios.scenario import drawn

    hobby = drawn(load_scenario("line", {"imperfect": "hobby"}), hexapod)
    assert hobby.payload is not None
    assert known_of(hobby) == ()
    handed = {"imperfect": "hobby", "command_delay": 0.01}
    assert known_of(drawn(load_scenario("line", handed), hexapod)) == ("command_delay",)


def test_what_is_given_beside_a_hobby_robots_draw_stays_and_is_known(hexapod):
    from sim.scenarios.scenario import drawn

    payload = (0.5, 0.0, 0.0, 0.05)
    found, plain = (
        drawn(load_scenario("line", {"imperfect": "hobby"} | given), hexapod)
        for given in ({"payload": payload}, {})
    )
    assert found.payload == payload != plain.payload
    assert (found.slope, found.foot_friction) == (plain.slope, plain.foot_friction)
    assert known_of(found) == ("payload",)


def test_an_unknown_imperfection_is_refused_by_its_name():
    from sim.errors import UsageError

    with pytest.raises(
        UsageError,
        match="known names 'paylod', which is no imperfection: .*did you mean 'payl",
    ):
        load_scenario("line", {"known": ["paylod"]})


def test_predictions_that_are_not_asked_for_are_left_out(laden):
    asked = simulated(predictions=["quasi_static"]).evaluation
    assert list(asked.predicted) == ["ideal", "quasi_static"]
    assert asked.unpredicted["compliant"] == "left out"


def test_a_robot_that_would_tip_over_has_no_prediction_and_the_time_is_told(
    laden, monkeypatch
):
    monkeypatch.setattr("sim.compliant.march.TIPPED", 1.1)
    found = evaluate(laden.walk, LEFT_OUT)
    assert found.unpredicted["compliant"] == "the robot tips over at 0.00 s"
    assert "compliant" not in found.predicted


@pytest.mark.parametrize("without", [["complaint"], "compliant"])
def test_what_no_walk_is_compared_with_cannot_be_left_out(without):
    with pytest.raises(UsageError, match="is not allowed: without; give some of ideal"):
        evaluate(None, without)
