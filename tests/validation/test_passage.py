"""Walks past walls in real physics: clear of them as predicted, and hitting as said."""

import numpy as np
import pytest

from sim.evaluation.assessment import evaluate, summarise
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_open_loop
from sim.planning.routes import routed
from sim.preparation.setup import prepare
from sim.run_folder import trajectory
from sim.scenarios.file import load_scenario
from sim.walking.walks import Walker, carry_out
from tests.walks import COSTLY

pytestmark = pytest.mark.physics

# Beside the left feet: a step to the left in few segments swings them into it.
BESIDE = {
    "path.goal": [0.0, 0.012, 0.0],
    "segments": 2,
    "obstacles": [{"kind": "box", "center": [0.0, 0.274], "size": [1.0, 0.1]}],
}


def run(name, **changes):
    setup, _ = within_bounds(routed(prepare(load_scenario(name, changes))))
    planned = None if setup.scenario.replan else plan_open_loop(setup)
    evaluation = evaluate(carry_out(Walker(setup), planned), COSTLY)
    return summarise(evaluation), dict(trajectory(evaluation))


@pytest.fixture(scope="module")
def careful():
    return run("line", **BESIDE)


def test_a_careful_walk_touches_nothing(careful):
    summary, _ = careful
    assert summary["segments"] > BESIDE["segments"]
    assert summary["wall_contacts"] == 0
    assert summary["achieved"]["min_clearance"] > 0


def test_the_clearance_is_as_predicted(careful):
    summary, arrays = careful
    predicted = summary["predicted"]["quasi_static"]["min_clearance"]
    assert predicted >= 0.002
    # open loop departs by half a millimetre at most on so short a way
    assert summary["achieved"]["min_clearance"] == pytest.approx(predicted, abs=5e-4)
    achieved, foreseen = arrays["achieved_clearance"], arrays["quasi_static_clearance"]
    assert achieved == pytest.approx(foreseen, abs=1e-3)


def test_a_coarse_walk_hits_where_the_prediction_does():
    summary, _ = run("line", **BESIDE, min_clearance=-1)
    assert summary["segments"] == BESIDE["segments"]
    assert summary["predicted"]["ideal"]["min_clearance"] < 0
    assert summary["wall_contacts"] > 0


def test_where_nothing_stands_nothing_is_near(careful):
    summary, arrays = run("line", **{**BESIDE, "obstacles": []})
    assert summary["wall_contacts"] == 0
    assert summary["achieved"]["min_clearance"] is None
    assert summary["predicted"]["ideal"]["min_clearance"] is None
    assert "achieved_clearance" not in arrays


@pytest.mark.full
@pytest.mark.parametrize("how", [{}, {"steer": "ideal", "replan": True}], ids=str)
def test_the_corridor_is_walked_without_touching_its_walls(how):
    summary, arrays = run("corridor", **how)
    assert summary["wall_contacts"] == 0
    # 5 mm are asked of the prediction; 5.2 and 5.5 measured
    assert summary["achieved"]["min_clearance"] > 0.004
    assert arrays["achieved_clearance"].min() > 0.004
    assert summary["error"]["goal"]["position"] < 0.01 * summary["path_length"]
    if not summary["replan"]:  # steered on the quasi-static prediction
        x, y, yaw = np.subtract(
            summary["predicted"]["quasi_static"]["pose"], summary["goal"]
        )
        assert np.hypot(x, y) < 1e-5  # what aiming promises, and rows' rounding
        assert abs(yaw) < 1e-5


@pytest.mark.full
def test_a_way_that_was_found_is_walked_without_touching_anything():
    summary, _ = run("detour")
    assert summary["wall_contacts"] == 0
    assert summary["achieved"]["min_clearance"] > 0.005
    assert summary["error"]["goal"]["position"] < 1e-3  # replanned


@pytest.mark.full
def test_the_corridor_walked_in_too_few_segments_is_hit():
    summary, _ = run("corridor", min_clearance=-1, steer="ideal")
    assert summary["predicted"]["quasi_static"]["min_clearance"] < 0
    assert summary["wall_contacts"] > 0
