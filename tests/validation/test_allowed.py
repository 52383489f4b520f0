"""What settings allow a walk, walks that share their worlds are not allowed."""

import pytest

from planner.errors import BudgetError
from sim.errors import SimulationError
from sim.preparation.shared import Shared
from sim.scenarios.file import load_scenario
from sim.simulation import simulate
from tests.validation.test_verdict import lopsided

pytestmark = pytest.mark.usefixtures("quick")


def test_what_one_walk_was_allowed_the_next_is_not(tmp_path):
    """Points of a sweep share what they have in common, in whatever worker."""
    changes = {"robot": str(lopsided(tmp_path)), "segments": 1, "timestep": 0.001}
    allowed, forbidden = (
        load_scenario(
            "line", changes | {"path.goal": [0.01, 0, 0], "allow_unstable": may}
        )
        for may in (True, False)
    )
    shared = Shared()
    done = simulate(allowed, without=("identified", "compliant"), shared=shared)
    assert done.summary.verdict == "fell"
    with pytest.raises(SimulationError, match="the plan tips the robot over"):
        simulate(forbidden, shared=shared)


def test_a_plan_that_was_made_in_time_is_none_for_less_time():
    changes = {"segments": 2, "path.goal": [0.01, 0, 0], "predictions": ["ideal"]}
    patient, hasty = (
        load_scenario("line", changes | {"plan_time": limit}) for limit in (300.0, 1e-6)
    )
    shared = Shared()
    assert simulate(patient, without=("creep_floor",), shared=shared).plan
    with pytest.raises(BudgetError, match="none within 1e-06 s"):
        simulate(hasty, shared=shared)
