"""Parts of the lower bound on time, each against what it stands for."""

from itertools import product
from math import inf, pi
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from sim.optimisation import lower_bound
from sim.optimisation.lower_bound import (
    Curve,
    _certificate,
    _headings,
    _largest_rate,
    _visits,
    least_time,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

ANGLES = 61  # of a group, between the ends of its range
EVERY = 4  # of these, in the linear program
HEADINGS = 0.005  # [rad] between two values of alpha on the grid at least

SPAN, LIFTS = 0.5, 0.6  # [rad], [s]


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


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
    assert len(found) == 200


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


@pytest.mark.parametrize("stances", [("1", "2"), ("1",)])
def test_a_bound_is_proven_by_all_groups_or_by_none(setup, monkeypatch, stances):
    """A stroke that has no curve, on all feet perhaps, may be the fastest."""
    seconds, curve = 1e6, bent()
    monkeypatch.setattr(lower_bound, "_proven", lambda *_: seconds)
    monkeypatch.setattr(
        lower_bound,
        "_curve",
        lambda _, task, s: curve if s.stratum in stances else None,
    )
    found = least_time(setup, 0.01)
    assert (found == seconds) == (len(stances) == 2)
    assert 0 < found < seconds or len(stances) == 2


def test_all_visits_but_one_may_lose_the_slowest_group_s_lifts(monkeypatch):
    """At pieces' ends: 1.2 s of the slower group, 0.2 s each of the other."""
    even = [
        Curve(bent().angles, bent().planar, bent().headings, 0.0,
              lifts + 3.0 * (bent().angles + SPAN), 0.0)
        for lifts in (0.1, 0.6)
    ]  # fmt: skip
    leads = np.array([[10.0, 0.0], [10.0, 0.0]])
    certificate = leads, np.zeros((2, ANGLES)), 0.0
    monkeypatch.setattr(lower_bound, "_certificate", lambda *_: certificate)
    monkeypatch.setattr(lower_bound, "_largest_rate", lambda *_: 0.5)
    points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 11)
    setup = SimpleNamespace(scenario=SimpleNamespace(overlap_recovery=False))
    for groups in (even, even[::-1]):
        found = lower_bound._proven(setup, groups, points, 0.01, 0.1, 2)
        assert found == pytest.approx(10.0 - 2 * 0.1 - 1.2)


def curve_of(monkeypatch, direct=1, fixed=2, **task):
    """Of strokes that turn a coordinate by 2 rad a second, after 0.6 s of lifts."""
    x, y, a, phi = state = sp.symbols("x y a phi")
    values = np.tile([[0.1], [0.0], [0.0]], (lower_bound.ANGLES * 20, 1, 1))
    compiled = SimpleNamespace(values=lambda s: values[: len(s)])
    stage, other = (SimpleNamespace(stroke="f", stratum=s, recoveries=()) for s in "12")
    other.recoveries = tuple(
        SimpleNamespace(field=name, rate=rate, coordinate=place)
        for name, rate, place in (("f", -0.5, 3), ("g", 4.0, 3), ("h", 1.0, 4))
    )
    system = SimpleNamespace(
        state=state, bottom="12", fields={"f": sp.Matrix([0.1, 0, 0, 2])},
        compiled=lambda _: compiled,
        switches=lambda one, two: fixed if one == "12" else direct,
    )  # fmt: skip
    price = {"f": 1.0, "g": 2.0, "h": 0.01}
    given = {"centred": False, "cost": price.__getitem__} | task
    task = SimpleNamespace(
        system=system, rates=lambda _: {2: 0.3, 3: 2.0}, limits={3: (-0.4, 0.6)},
        stages=[stage, other], **given,
    )  # fmt: skip
    judge = SimpleNamespace(duration=lambda flows: 0.6 + flows[0].duration)
    monkeypatch.setattr(lower_bound, "Judge", lambda _: judge)
    limits = SimpleNamespace(timestep=0.0)
    return lower_bound._curve(SimpleNamespace(limits=limits), task, stage)


def test_strokes_of_a_curve_take_the_range_at_its_rate_and_shared_lifts(monkeypatch):
    """1 rad at 2 rad/s; of four switches a visit has one that others do not share."""
    curve = curve_of(monkeypatch)
    assert np.ptp(curve.times) == pytest.approx(0.5)
    assert curve.times[0] == pytest.approx(0.6 / 4)
    assert curve_of(monkeypatch, direct=8).times[0] == pytest.approx(0.6)
    assert np.ptp(curve.planar.real) == pytest.approx(0.1 / 2)


def test_a_recovery_is_as_cheap_as_the_cheapest_of_the_group(monkeypatch):
    """2 s a radian of one, 0.5 of the other; where none is priced, it is free."""
    assert curve_of(monkeypatch).slope == pytest.approx(0.5)
    assert curve_of(monkeypatch, centred=True).slope == 0.0
