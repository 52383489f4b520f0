"""What predictions are called, what they ignore, and which one judges a walk."""

from sim.scenarios.file import load_scenario
from sim.scenarios.predictions import (
    COMPLIANT,
    IDEAL,
    IDENTIFIED,
    PREDICTIONS,
    QUASI_STATIC,
    best,
    who_ignores,
)
from sim.scenarios.settings import SETTINGS

WRONG = {"slope": [0.1, 0.0], "payload": [0.1, 0, 0, 0], "foot_friction": [1.0] * 6}


def test_a_prediction_ignores_what_the_scenario_sets_and_it_knows_nothing_of():
    scenario = load_scenario("line", WRONG)
    assert QUASI_STATIC.ignored(scenario) == "payload, slope, foot_friction"
    assert IDENTIFIED.ignored(scenario) == "payload, slope"  # its margin does
    assert COMPLIANT.ignored(scenario) == ""
    drawn = load_scenario("line", {"zero_offset": 0.01, "bumps": 0.001})
    assert COMPLIANT.ignored(drawn) == "zero_offset, bumps"
    assert IDEAL.ignored(load_scenario("line")) == ""
    assert all(
        n in SETTINGS for each in PREDICTIONS.values() for n in each.ignores or ()
    )


def test_predictions_that_ignore_the_same_are_named_together():
    ignored = {"ideal": "slope", "quasi_static": "slope", "identified": ""}
    assert who_ignores(ignored) == "slope (ideal, quasi-static)"
    assert who_ignores({"ideal": ""}) == ""


def test_a_walk_is_judged_by_the_best_prediction_that_could_be_made():
    assert best(["ideal", "compliant", "quasi_static"]) == "compliant"
    assert best(["ideal", "identified", "quasi_static"]) == "quasi_static"
    assert best(["identified", "ideal"]) == "ideal"
