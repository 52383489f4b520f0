"""Parts of the lower bound on time, each against what it stands for."""

from itertools import product
from math import inf, pi

import numpy as np
import pytest

from sim.optimisation import lower_bound
from sim.optimisation.lower_bound import (
    ANGLES,
    EVERY,
    HEADINGS,
    Curve,
    _certificate,
    _headings,
    _largest_rate,
    _visits,
)

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
