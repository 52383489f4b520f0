"""What the optimiser is asked for, from a scenario."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner import Flow
from planner.optimisation import CHEAP
from sim.experiments.identification import twist_model
from sim.optimisation import judging
from sim.optimisation.judging import (
    Judge,
    least_clearance,
    real_equations,
    task_of,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line", {"segments": 1, "optimise": "switches"}))


def plan_of(setup, *flows):
    """A plan of one segment, as far as a judge looks at it."""
    flows = [Flow(*flow) for flow in flows]
    return SimpleNamespace(
        system=setup.equations.system, flows=flows, segments=lambda: iter([flows])
    )


def wanting(setup, **changes):
    return replace(setup, scenario=replace(setup.scenario, **changes))


def test_settings_of_one_world_do_not_share_the_strokes_of_another_prediction(
    scenario, hexapod, monkeypatch
):
    asked = []

    def recorded(setup, prediction):
        asked.append(prediction)
        return twist_model(setup, "quasi_static")  # identifying takes seconds

    monkeypatch.setattr(judging, "twist_model", recorded)
    setup = prepare(scenario(steer="quasi-static"), hexapod)
    other = replace(setup, scenario=scenario(steer="identified"))
    assert setup == other
    for one in (setup, other, setup):
        real_equations(one)
    assert asked == ["quasi_static", "identified"]


def test_one_switch_outweighs_all_time_and_of_as_many_the_faster_plan_is_better(setup):
    judge = Judge(setup)
    short, long, more = (
        plan_of(setup, *flows)
        for flows in (
            [("1", "g1_1", 0.1)],
            [("1", "g1_1", 0.3)],
            [("1", "g1_1", 0.1), ("2", "g2_2", 0.1)],
        )
    )
    worth = [judge.worth(plan) for plan in (short, long, more)]
    assert judge.duration(long.flows) > judge.duration(short.flows) + 0.1
    assert worth == sorted(worth)
    # a tripod lifts off and touches down, then perhaps the other one does
    assert np.subtract(worth, [2, 2, 4]) == pytest.approx(0, abs=1e-4)
    assert min(np.subtract(worth, [2, 2, 4])) > 0
    assert worth[0] < worth[1]


def test_strokes_are_the_ways_of_tripods_that_stand_either_way(setup):
    judge = Judge(wanting(setup, optimise="strokes"))
    flows = ("1", "g1_1", 0.1), ("1", "g1_2", 0.4), ("12", "g12_2", -0.2)
    assert judge.worth(plan_of(setup, *flows)) == pytest.approx(0.1 + 0.2)


def test_standing_still_lacks_nothing_and_is_where_it_was(setup):
    kept = {"min_margin": 0.5, "min_clearance": 0.9, "obstacles": ((1.0, 1.0, 0.1),)}
    still = Judge(wanting(setup, **kept))
    assert still.margin_lack([]) == still.clearance_lack([]) == 0
    assert still.poses(plan_of(setup)).tolist() == [[0, 0, 0]]
    # and where nothing is asked for, nothing lacks on the way either
    swing = [[Flow("1", "g1_1", 0.1)]]
    free = Judge(wanting(setup, min_margin=None))
    assert free.margin_lack(swing) == free.clearance_lack(swing) == 0


def test_no_clearance_at_all_may_be_asked_for_but_less_is_no_wish(setup):
    walls = {"obstacles": ((1.0, 1.0, 0.1),)}
    least = [
        least_clearance(wanting(setup, **given))
        for given in (walls | {"min_clearance": 0.0}, walls | {"min_clearance": -1.0})
    ]
    assert least == [0.0, None]
    assert least_clearance(wanting(setup, min_clearance=0.0)) is None


def test_returns_in_the_air_cost_little_where_strokes_are_counted(setup):
    for objective, cheap in (("strokes", CHEAP), ("time", 1.0)):
        price = task_of(wanting(setup, optimise=objective), (0.01, 0.1)).price
        assert price["g1_2"] == pytest.approx(cheap * price["g1_1"])


def test_legs_that_stroke_together_are_set_anew_within_their_range_and_end_at_rest():
    """Of a robot that could not go a stroke of 0.9 rad at once, nor stand after it."""
    quadruped = prepare(load_scenario("line", {"robot": "quadruped"}))
    asked = [[Flow("1234", "g1234_forward", 0.9)]]
    (found,) = Judge(quadruped).stepped(asked)
    swings, limits = quadruped.equations.swings, quadruped.equations.limits
    moved = [np.multiply(swings[flow.field], flow.duration) for flow in found]
    angles = np.cumsum(moved, axis=0)
    low, high = np.array([*limits.values()]).T
    assert (angles >= low - 1e-9).all()
    assert (angles <= high + 1e-9).all()
    assert angles[-1] == pytest.approx(np.zeros(4), abs=1e-9)
    forward = [flow.duration for flow in found if flow.field == "g1234_forward"]
    assert sum(forward) == pytest.approx(0.9)


def test_optimised_plans_keep_a_tenth_of_a_milliradian_from_the_ends_of_the_range(
    setup,
):
    """So that servos which follow them within that stay in the range."""
    task, names = task_of(setup, (0.01, 0.1)), setup.equations.system.state
    for index, (low, high) in task.limits.items():
        ends = setup.equations.limits[str(names[index])]
        assert (low - ends[0], ends[1] - high) == pytest.approx((1e-4, 1e-4))
