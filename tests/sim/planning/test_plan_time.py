"""Planning has a time to end in, whatever is asked for."""

import pytest

from planner.errors import BudgetError
from sim.scenarios.file import load_scenario
from sim.simulation import simulate

ASKED = {
    "segments cut again and again": ("corridor", {"min_clearance": 0.02}),
    "numbers of segments tried": ("line", {"segments": 2, "path.goal": [40, 0, 0]}),
    "segments without number": ("line", {"segments": 3000}),
}


@pytest.mark.parametrize(("name", "asked"), ASKED.values(), ids=ASKED)
def test_a_plan_that_takes_too_long_is_refused(name, asked):
    scenario = load_scenario(name, {"plan_time": 1e-3} | asked)
    with pytest.raises(BudgetError, match="none within 0.001 s"):
        simulate(scenario)
