"""No walk is quicker than the lower bound on its time."""

import numpy as np
import pytest

from sim.optimisation.judging import Judge, least_time, shortest_way, top_speed
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


def test_a_straight_way_may_not_be_cut():
    points = np.linspace([0.0, 0.0], [3.0, 4.0], 11)
    assert shortest_way(points, 0.5) == pytest.approx(5.0)


def test_a_way_to_and_fro_may_turn_early():
    there = np.linspace([0.0, 0.0], [2.0, 0.0], 11)
    points = np.concatenate([there, there[-2::-1]])
    assert shortest_way(points, 0.3) == pytest.approx(2 * (2.0 - 0.3))


def test_a_way_that_never_has_to_leave_is_nothing():
    turn = np.linspace(0.0, 2 * np.pi, 50)[:, None]
    points = 0.1 * np.hstack([np.cos(turn) - 1.0, np.sin(turn)])
    assert shortest_way(points, 0.3) == pytest.approx(0.0, abs=1e-15)


def test_the_body_is_no_faster_than_its_stride():
    setup = prepare(load_scenario("line"))
    stride = max(setup.equations.stride(name) for name in setup.equations.elements[:2])
    least = stride * setup.limits.swing_speed
    assert least <= top_speed(setup) < 1.2 * least


def test_a_plan_takes_longer():
    setup = prepare(load_scenario("line", {"path.goal": [0.1, 0.0, 0.0]}))
    planned = plan_open_loop(setup)
    judge = Judge(setup)
    bound = least_time(setup, judge.deviation(planned).position)
    assert 0.1 < bound < judge.duration(planned.flows)
