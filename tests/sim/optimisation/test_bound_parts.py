"""Parts of the lower bound on time, each against what it stands for."""

from itertools import product
from math import inf, pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from planner import Flow
from sim.optimisation import lower_bound
from sim.optimisation.judging import Judge, task_of
from sim.optimisation.lower_bound import (
    ANGLES,
    EVERY,
    HEADINGS,
    ROUNDED_STEPS,
    Curve,
    _certificate,
    _curve,
    _headings,
    _largest_rate,
    _visits,
    least_time,
    shortest_way,
    top_speed,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

SPAN, LIFTS = 0.5, 0.6  # [rad], [s]


def bent(slope=1.5, turning=0.6, bend=0.05, lifts=LIFTS):
    """A group whose strokes move the body along an arc, and turn it on the way."""
    angles = np.linspace(-SPAN, SPAN, ANGLES)
    places = 0.04 * angles + 0.5j * bend * angles**2
    times = lifts + 2.0 * (angles + SPAN) + 0.1 * (1 - np.exp(-8 * (angles + SPAN)))
    return Curve(angles, places, turning * angles, bend, times, slope)


def test_parts_of_a_visit_take_at_most_a_spare_time_beyond_the_whole():
    """Strokes gather speed, so that T is concave; its last slope is the steady pace."""
    curve = bent()
    taken = [
        curve.times[a] + curve.times[b] - curve.times[a + b]
        for a, b in product(range(ANGLES), repeat=2)
        if a + b < ANGLES
    ]
    assert curve.spacing == pytest.approx(2 * SPAN / (ANGLES - 1))
    assert max(taken) <= curve.spare <= max(taken) + 0.02
    even = LIFTS + 3.0 * (curve.angles + SPAN)
    plain = Curve(curve.angles, curve.planar, curve.headings, 0.0, even, 0.0)
    assert plain.spare == pytest.approx(LIFTS)


@pytest.mark.parametrize("span", [(-0.1, 0.2), (0.1, 0.1), (2.0, 2.3)])
def test_headings_are_all_that_bring_the_body_into_a_span(span):
    curve = bent()
    found = _headings(curve, span, None)
    assert found[0] == pytest.approx(span[0] - curve.headings.max())
    assert found[-1] == pytest.approx(span[1] - curve.headings.min())
    assert np.diff(found) == pytest.approx(np.full(len(found) - 1, np.diff(found)[0]))
    assert np.diff(found)[0] <= HEADINGS
    assert np.diff(found)[0] > 0.9 * HEADINGS
    assert _headings(curve, span, 7) == pytest.approx(
        np.linspace(found[0], found[-1], 7)
    )


@pytest.mark.parametrize(("span", "ends"), [
    ((-inf, inf), (-pi, pi)), ((0.3, 9.0), (0.0, 2 * pi)),
])  # fmt: skip
def test_headings_go_round_once_at_most(span, ends):
    curve = bent()
    found = _headings(curve, span, None)
    assert (found[0], found[-1]) == pytest.approx(ends)
    assert len(found) == lower_bound.MOST_HEADINGS


@pytest.mark.parametrize("room", [0.0, 0.07])
def test_visits_are_all_pairs_of_angles_within_the_span(room):
    curve, span = bent(), (-0.15, 0.1)
    alpha, knots = np.linspace(-0.5, 0.4, 9), np.arange(0, ANGLES, 10)
    found = set(
        zip(
            *(n.tolist() for n in _visits(curve, span, alpha, knots, room)), strict=True
        )
    )

    def within(k, knot):
        heading = alpha[k] + curve.headings[knots[knot]]
        return span[0] - room <= heading <= span[1] + room

    every = product(range(len(alpha)), *[range(len(knots))] * 2)
    assert found == {(k, a, b) for k, a, b in every if within(k, a) and within(k, b)}
    assert found


def gain(curve, lead, alpha, a, b):
    """Part lambda . R(alpha) (G(b) - G(a)) of angles anywhere in the range."""
    place = [
        np.interp(x, curve.angles, curve.planar.real) + 1j * (0.5 * curve.bend * x * x)
        for x in (a, b)
    ]
    moved = np.exp(1j * alpha) * (place[1] - place[0])
    return lead[0] * moved.real + lead[1] * moved.imag


@pytest.mark.parametrize("lead", [(30.0, 0.0), (20.0, -25.0)])
@pytest.mark.parametrize("weight", [1.0, 0.4])
def test_no_visit_between_the_angles_of_the_grid_gains_more_than_rho(lead, weight):
    """Rho is of all visits, and only just larger than needed."""
    curve, span, lead = bent(), (-0.1, 0.1), np.array(lead)
    height = 0.2 * np.cos(3 * curve.angles)
    rho = _largest_rate(curve, span, lead, height, weight)
    rng = np.random.default_rng(0)
    a, b = rng.uniform(-SPAN, SPAN, (2, 40_000))
    alpha = rng.uniform(-0.45, 0.45, 40_000)
    inside = np.all([np.abs(alpha + 0.6 * x) <= 0.1 for x in (a, b)], axis=0)
    a, b, alpha = a[inside], b[inside], alpha[inside]
    lifts = curve.times[0]
    times = np.interp(np.abs(b - a), curve.angles + SPAN, curve.times)
    rises = np.interp(b, curve.angles, height) - np.interp(a, curve.angles, height)
    needed = (gain(curve, lead, alpha, a, b) + rises) / (
        lifts + weight * (times - lifts)
    )
    assert len(needed) > 1000
    assert needed.max() <= rho
    # a room of one cell of headings, and corners for what lies between
    assert rho < 1.25 * needed.max()


def test_rho_leaves_room_for_what_a_grid_misses():
    """Spacing^2 / 8 times the second derivatives, of both angles and of alpha."""
    curve, span, lead = bent(bend=3.0), (-0.1, 0.1), np.array([0.3, 0.4])
    flat = np.zeros(ANGLES)
    rough = 1e-6  # of fields [m/rad]
    alpha = _headings(curve, span, None)
    apart, spacing = alpha[1] - alpha[0], curve.spacing
    reach = np.abs(curve.planar[:, None] - curve.planar).max()
    missed = 0.5 * (2 * spacing**2 * 3.0 + apart**2 * reach) / 8
    room = apart + np.abs(np.diff(curve.headings)).max()
    best = -inf
    for angle in alpha:
        heading = angle + curve.headings
        own = np.flatnonzero((heading >= -0.1 - room) & (heading <= 0.1 + room))
        for a, b in product(own, own):
            moved = np.exp(1j * angle) * (curve.planar[b] - curve.planar[a])
            way = abs(int(b) - int(a))
            gained = 0.3 * moved.real + 0.4 * moved.imag + missed
            gained += 0.5 * rough * way * spacing
            best = max(best, gained / (LIFTS + 0.5 * (curve.times[way] - LIFTS)))
    assert _largest_rate(curve, span, lead, flat, 0.5) == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("overlapped", [False, True])
def test_a_certificate_keeps_the_condition_on_its_part_of_the_grid(overlapped):
    curves, spans = [bent(), bent(1.0, -0.4)], [(-0.1, 0.1), (0.0, 0.2)]
    ways, loose = np.array([[0.1, 0.0], [0.05, 0.05]]), np.array([0.001, 0.001])
    leads, heights, share = _certificate(curves, spans, ways, loose, overlapped)
    assert leads.shape == (2, 2)
    assert heights.shape == (2, ANGLES)
    assert 0 <= share <= 1 if overlapped else share == 0.0
    assert (leads * ways).sum() > 0.1  # it proves some time
    for curve, height in zip(curves, heights, strict=True):
        steep = np.abs(np.diff(height)).max() / curve.spacing
        assert steep <= curve.slope * (share if overlapped else 1.0) + 1e-6
        knots = np.arange(0, ANGLES, EVERY)
        on_line = np.interp(np.arange(ANGLES), knots, height[knots])
        assert height == pytest.approx(on_line, abs=1e-9)
        tightest = -inf
        for span, lead in zip(spans, leads, strict=True):
            alpha = _headings(curve, span, lower_bound.FEW_HEADINGS)
            k, a, b = _visits(curve, span, alpha, knots, 0.0)
            a, b = knots[a], knots[b]
            moved = np.exp(1j * alpha[k]) * (curve.planar[b] - curve.planar[a])
            times = curve.times[np.abs(b - a)]
            left = lead[0] * moved.real + lead[1] * moved.imag + height[b] - height[a]
            over = left + share * (times - curve.times[0]) - times
            assert over.max() < 1e-6
            tightest = max(tightest, over.max())
        assert tightest > -0.5


def test_a_certificate_weighs_the_tolerance_at_cuts():
    """The looser the cuts, the less lambda is worth; a loose end is not sought."""
    curve, spans = bent(), [(-0.1, 0.1)]
    way = np.array([[0.1, 0.0]])
    lengths = [
        np.linalg.norm(_certificate([curve], spans, way, np.array([loose]), False)[0])
        for loose in (0.0, 0.09, 0.2)
    ]
    assert lengths[0] > 1.0
    assert lengths[1] > 1.0
    assert lengths[2] == pytest.approx(0.0, abs=1e-6)


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
