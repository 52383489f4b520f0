"""What the lower bound on time knows of a robot: curves, times, and speeds."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from planner import Flow
from sim.optimisation import lower_bound
from sim.optimisation.judging import Judge, task_of
from sim.optimisation.lower_bound import (
    Curve,
    _curve,
    least_time,
    shortest_way,
    top_speed,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

ANGLES = 61  # of a group, between the ends of its range
ROUNDED_STEPS = 3  # of physics, to which a visit is rounded up at most


@pytest.fixture(scope="module")
def hexapod_task():
    setup = prepare(load_scenario("line"))
    return setup, task_of(setup, (0.02, 0.2))


def test_the_curve_of_a_stroke_is_the_integral_of_its_field(hexapod_task):
    setup, task = hexapod_task
    stage = next(s for s in task.stages if s.stroke and s.stratum != task.system.bottom)
    curve = _curve(setup, task, stage)
    ((own, rate),) = ((i, r) for i, r in task.rates(stage).items() if i > 2)
    low, high = task.limits[own]
    assert (curve.angles[0], curve.angles[-1]) == pytest.approx((low, high))
    assert len(curve.angles) == ANGLES

    def moved(angle, pose):
        state = np.zeros((1, len(task.system.state)))
        state[0, own], state[0, 2] = angle, pose[2]
        return task.system.compiled(stage.stroke).values(state)[0, :3, 0] / rate

    def path(begin, end, pose, at):
        return solve_ivp(moved, (begin, end), pose, t_eval=at, rtol=1e-9, atol=1e-11).y

    headings = path(0.0, high, (0.0, 0.0, 0.0), [high])[2, -1]
    assert curve.headings[-1] == pytest.approx(headings, abs=1e-6)
    assert np.interp(0.0, curve.angles, curve.headings) == pytest.approx(0.0, abs=1e-9)
    begin = (0.0, 0.0, float(curve.headings[0]))
    x, y, yaw = path(low, high, begin, curve.angles)
    assert curve.headings == pytest.approx(yaw, abs=1e-6)
    assert np.abs(curve.planar - (x + 1j * y)).max() < 1e-6
    second = np.diff(curve.planar, 2) / curve.spacing**2
    assert np.abs(second).max() <= curve.bend < 1.1 * np.abs(second).max()


def test_times_of_strokes_are_those_of_visits_but_for_rounding_and_shared_lifts(
    hexapod_task,
):
    setup, task = hexapod_task
    stage = next(s for s in task.stages if s.stroke and s.stratum != task.system.bottom)
    curve, judge = _curve(setup, task, stage), Judge(setup)
    ((_, rate),) = ((i, r) for i, r in task.rates(stage).items() if i > 2)
    only = judge.duration([Flow(stage.stratum, stage.stroke, 1e-9 / rate)])
    rounded = ROUNDED_STEPS * setup.limits.timestep
    whole = [
        judge.duration([Flow(stage.stratum, stage.stroke, way / rate)])
        for way in (curve.angles - curve.angles[0])[1:]
    ]
    shared = whole[0] - rounded - curve.times[1]
    assert curve.times[1:] == pytest.approx(np.array(whole) - rounded - shared)
    assert curve.times[0] == pytest.approx(only - rounded - shared)
    # the two strata are 2 switches apart, and lifting and landing takes 2 as well
    other = next(
        s.stratum
        for s in task.stages
        if s.stratum not in (stage.stratum, task.system.bottom)
    )
    direct = task.system.switches(stage.stratum, other)
    lifts = 2 * task.system.switches(task.system.bottom, stage.stratum)
    part = max(0.0, 1 - direct / lifts)
    assert shared == pytest.approx(part * (only - rounded))


def test_the_slope_is_that_of_the_cheapest_recovery(hexapod_task):
    setup, task = hexapod_task
    for stage in task.stages:
        if not stage.stroke or stage.stratum == task.system.bottom:
            continue
        curve = _curve(setup, task, stage)
        ((own, _),) = ((i, r) for i, r in task.rates(stage).items() if i > 2)
        prices = [
            task.cost(recovery.field) / abs(recovery.rate)
            for other in task.stages
            for recovery in other.recoveries
            if recovery.coordinate == own
        ]
        assert prices
        assert curve.slope == min(prices) > 0


def test_speed_is_the_largest_of_any_stroke_at_any_angles():
    """One coordinate a group; the fields' own velocities, at the pace of the swing."""
    setup = prepare(load_scenario("line"))
    twists, described = lower_bound.real_twists(setup), setup.equations
    low, high = np.array(list(described.limits.values())).T
    rng, fastest = np.random.default_rng(0), 0.0
    swings = low + rng.uniform(size=(2000, len(low))) * (high - low)
    swings[:4] = [low, high, [low[0], high[1]], [high[0], low[1]]]
    for name in set(described.elements) & set(described.swings):
        rates = np.array(described.swings[name], dtype=float)
        rates *= setup.limits.swing_speed / np.abs(rates).max()
        stratum = described.system.stratum_of[name]
        moved = twists(stratum, swings, np.tile(rates, (len(swings), 1)))
        fastest = max(fastest, float(np.hypot(moved[:, 0], moved[:, 1]).max()))
    assert top_speed(setup) == pytest.approx(fastest, rel=2e-3)


def test_groups_too_many_for_a_grid_are_drawn_and_nearly_as_fast(monkeypatch):
    setup = prepare(load_scenario("line"))
    exact = top_speed(setup)
    monkeypatch.setattr(lower_bound, "MOST_GRIDDED", 1)
    assert 0.9 * exact < top_speed(setup) <= exact * 1.001


def test_a_way_through_circles_is_the_longest_sum_between_some_of_them():
    """By trying all subsets of points between the first and the last."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        points, within = rng.normal(size=(6, 2)), float(rng.uniform(0, 1))
        best = 0.0
        for kept in product([False, True], repeat=4):
            chosen = [0, *(k + 1 for k in range(4) if kept[k]), 5]
            radii = [0.0 if k in (0, 5) else within for k in chosen]
            ways = np.linalg.norm(np.diff(points[chosen], axis=0), axis=1)
            best = max(best, ways.sum() - 2 * sum(radii))
        assert shortest_way(points, within) == pytest.approx(best)


def test_the_bound_is_no_less_than_the_way_at_the_largest_speed(monkeypatch):
    setup = prepare(load_scenario("line", {"path.goal": [0.1, 0.0, 0.0]}))
    monkeypatch.setattr(lower_bound, "_proven", lambda *_: 0.0)
    assert least_time(setup, 0.01) == pytest.approx(0.1 / top_speed(setup))
    monkeypatch.setattr(lower_bound, "_proven", lambda *given: 10.0 * given[-1])
    assert least_time(setup, 0.01) == 40.0  # of one to four pieces, the best


@pytest.mark.parametrize("count", [1, 2, 4])
def test_pieces_of_a_path_have_their_own_headings_ways_and_room_at_cuts(
    monkeypatch, count
):
    """A heading that grows all along the path; only its ends are met exactly."""
    seen = []
    monkeypatch.setattr(lower_bound, "_certificate", lambda *given: seen.append(given))
    setup = prepare(load_scenario("line"))
    share = np.linspace(0, 1, 101)
    points = np.stack([share, share**2, 2 * share], axis=1)
    assert lower_bound._proven(setup, [], points, 0.01, 0.1, count) == 0.0
    ((_, spans, ways, loose, overlapped),) = seen
    edges = np.linspace(0, 1, count + 1)
    for (low, high), begin, end in zip(spans, edges[:-1], edges[1:], strict=True):
        assert (low, high) == pytest.approx((2 * begin - 0.1, 2 * end + 0.1))
    assert ways == pytest.approx(np.diff(np.stack([edges, edges**2], axis=1), axis=0))
    cuts = np.full(count + 1, 0.01)
    cuts[[0, -1]] = 0.0
    assert loose == pytest.approx(cuts[1:] + cuts[:-1])
    assert overlapped is False


def test_what_is_proven_is_the_gain_over_rho_less_a_visit_at_each_cut(monkeypatch):
    setup = prepare(load_scenario("line"))
    points = np.stack([np.linspace(0, 1, 101), np.zeros(101), np.zeros(101)], axis=1)
    leads = np.array([[30.0, 0.0], [40.0, 0.0]])
    angles = np.linspace(-0.5, 0.5, ANGLES)
    slow = Curve(angles, 0 * angles, 0 * angles, 0.0, 0.3 + 2 * (angles + 0.5), 0.0)
    found = leads, np.zeros((1, ANGLES)), 0.25
    asked = []
    monkeypatch.setattr(lower_bound, "_certificate", lambda *_: found)

    def rate(curve, span, lead, height, weight):
        asked.append(weight)
        return 2.0 if lead[0] == 40.0 else 0.5

    monkeypatch.setattr(lower_bound, "_largest_rate", rate)
    proven = lower_bound._proven(setup, [slow], points, 0.01, 0.1, 2)
    gained = 30 * 0.5 + 40 * 0.5 - (30 + 40) * 0.01
    assert proven == pytest.approx(gained / 2.0 - (0.3 + slow.spare))
    assert asked == [0.75, 0.75]
    monkeypatch.setattr(lower_bound, "_largest_rate", lambda *_: 0.1)
    fast = lower_bound._proven(setup, [slow], points, 0.01, 0.1, 2)
    assert fast == pytest.approx(gained - (0.3 + slow.spare))  # rho is at least 1
