"""No walk is quicker than the lower bound on its time."""

from dataclasses import replace

import numpy as np
import pytest

from planner import Flow
from sim.optimisation import lower_bound
from sim.optimisation.judging import Judge
from sim.optimisation.lower_bound import Curve, least_time, shortest_way, top_speed
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

ANGLES = 61  # of a group, between the ends of its range


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
    setup = prepare(
        load_scenario("line", {"path.goal": [0.05, 0.0, 0.0], "segments": 10})
    )
    planned = plan_open_loop(setup)
    judge = Judge(setup)
    bound = least_time(setup, judge.deviation(planned).position)
    assert 0.1 < bound < judge.duration(planned.flows)


SPAN, STRIDE, LIFTS, PACE = 0.5, 0.04, 0.6, 2.0  # [rad], [m/rad], [s], [s/rad]


def slide(sideways, recovery):
    """A group whose strokes move the body along a straight line, without turning."""
    angles = np.linspace(-SPAN, SPAN, ANGLES)
    places = STRIDE * angles * np.exp(1j * sideways)
    times = LIFTS + PACE * (angles + SPAN)
    return Curve(angles, places, np.zeros_like(angles), 0.0, times, recovery)


def bound_of(curves, way, tolerance=0.0, overlapped=False):
    setup = prepare(load_scenario("line", {"overlap_recovery": overlapped}))
    points = np.linspace([0.0, 0.0, 0.0], [*way, 0.0], 101)
    return lower_bound._proven(setup, curves, points, 0.01, tolerance, 1)


@pytest.mark.parametrize("recovery", [0.0, 1.0, PACE])
def test_the_bound_of_strokes_to_and_fro_is_their_time(recovery):
    """The best visits use the whole range, and the legs come back as quickly."""
    visit = LIFTS + (PACE + recovery) * 2 * SPAN
    exact = 1.0 / (STRIDE * 2 * SPAN) * visit
    found = bound_of([slide(0.0, recovery)], (1.0, 0.0), 1e-6)
    assert found <= exact
    assert found == pytest.approx(exact, rel=1e-3)


def test_recoveries_during_strokes_count_by_the_longer_of_both():
    exact = 1.0 / (STRIDE * 2 * SPAN) * (LIFTS + PACE * 2 * SPAN)
    found = bound_of([slide(0.0, PACE)], (1.0, 0.0), 1e-6, overlapped=True)
    assert found == pytest.approx(exact, rel=1e-3)
    assert found <= exact


def test_ways_across_are_composed_of_both_groups_strokes():
    """Two groups that move the body at right angles: each does its own part."""
    visit = LIFTS + 2 * PACE * 2 * SPAN
    exact = (1.0 + 0.5) / (STRIDE * 2 * SPAN) * visit
    curves = [slide(0.0, PACE), slide(np.pi / 2, PACE)]
    found = bound_of(curves, (1.0, 0.5), 1e-6)
    assert exact * (1 - 1e-3) < found <= exact


def test_a_cut_of_the_path_costs_at_least_the_lifts_of_a_visit_that_it_divides():
    """Both parts are bounded as visits of their own, each with lifts."""
    setup, slow = prepare(load_scenario("line")), slide(0.0, PACE)
    slow = replace(slow, times=slow.times + 1.0)
    points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 101)
    found = lower_bound._proven(setup, [slow], points, 0.0, 1e-6, 2)
    exact = 1.0 / (STRIDE * 2 * SPAN) * (LIFTS + 1.0 + 2 * PACE * 2 * SPAN)
    assert 0.9 * exact < found <= exact - (LIFTS + 1.0)


def test_no_random_walk_is_quicker():
    """Strokes and recoveries drawn at random, for the goal that they happen to meet."""
    setup = prepare(load_scenario("line"))
    judge, rng = Judge(setup), np.random.default_rng(4)
    for _ in range(2):
        flows, turned, farthest = [], 0.0, 0.0
        for k in range(8):
            own, angle = k % 2 + 1, float(rng.uniform(0.1, 0.4)) * (-1) ** (k // 2)
            flows += [
                Flow(f"{own}", f"g{own}_{own}", angle),
                Flow(f"{3 - own}", f"g{3 - own}_{own}", -angle),
            ]
            turned += (1, -1)[k % 2] * 0.57 * angle
            farthest = max(farthest, abs(turned) + 0.01)
        pose = judge.end(flows)[:3]
        changes = {"path.goal": [float(pose[0]), float(pose[1]), 0.0]}
        walked = prepare(load_scenario("line", changes))
        least = least_time(walked, within=1.0, yaw=farthest)
        assert 0.0 < least < judge.duration(flows)


def test_lifts_and_recoveries_count():
    """The fastest stroke alone would take 11 s; 72.3 s are known to be possible."""
    setup = prepare(load_scenario("line"))
    assert 50.0 < least_time(setup, 0.019, 0.17) < 72.3


def test_a_path_that_ends_where_it_began_takes_time():
    setup = prepare(load_scenario("ellipse"))
    assert 25.0 < least_time(setup, 0.029, 0.216) < 70.5


def test_strokes_with_all_feet_down_are_bounded_by_their_speed(monkeypatch):
    setup = prepare(load_scenario("line", {"fields": "paper"}))
    points = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, 101))
    plain = shortest_way(points[:, :2], 0.019) / top_speed(setup)
    assert least_time(setup, 0.019, 0.17) == pytest.approx(plain)
