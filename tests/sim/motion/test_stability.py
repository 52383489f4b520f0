"""Stability margin against an independent computation, and its limiting cases."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from sim.motion.stability import LeastMargin, stability_margin

TRIPOD = np.array([(0.15, 0.18), (0.0, -0.12), (-0.15, 0.18)])


def margin(points, weight, contact=None):
    points = np.asarray(points, dtype=float)
    contact = np.ones(len(points), bool) if contact is None else np.array(contact, bool)
    return stability_margin(points[None], contact[None], np.array([weight], float))[0]


def half_planes(points, weight):
    """Margin of a weight inside: least distance to a line with all feet on one side."""
    distances = []
    for i, a in enumerate(points):
        for j, b in enumerate(points):
            if i == j:
                continue
            normal = np.array([a[1] - b[1], b[0] - a[0]]) / np.hypot(*(b - a))
            if ((points - a) @ normal >= -1e-12).all():
                distances.append((weight - a) @ normal)
    return min(distances)


def test_margin_of_the_tripod_at_rest():
    # the side from (0.15, 0.18) to (0, -0.12): its distance from the origin
    side = np.array([0.15, 0.30]) / np.hypot(0.15, 0.30)
    expected = abs(np.cross([*side, 0], [0.0, 0.12, 0.0])[2])
    assert margin(TRIPOD, (0, 0)) == pytest.approx(expected, abs=1e-15)
    assert margin(TRIPOD, (0, 0)) == pytest.approx(0.0537, abs=5e-5)  # two digits given


def test_margin_inside_is_the_least_distance_to_the_lines_of_the_hull():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(200, 6, 2))
    weights = points.mean(axis=1) + 0.05 * rng.normal(size=(200, 2))
    found = stability_margin(points, np.ones((200, 6), bool), weights)
    expected = [half_planes(p, w) for p, w in zip(points, weights, strict=True)]
    inside = np.array(expected) > 0
    assert inside.sum() > 100
    assert found[inside] == pytest.approx(np.array(expected)[inside], abs=1e-12)
    assert (found[~inside] < 0).all()


def test_margin_outside_is_minus_the_distance_to_the_polygon():
    assert margin(TRIPOD, (0.0, 0.28)) == pytest.approx(-0.10)
    assert margin(TRIPOD, (0.0, -0.22)) == pytest.approx(-0.10)


def test_feet_in_the_air_support_nothing():
    four = np.vstack([TRIPOD, [(0.0, 5.0)]])
    assert margin(four, (0, 0), (1, 1, 1, 0)) == pytest.approx(margin(TRIPOD, (0, 0)))


def test_with_two_feet_the_margin_is_minus_the_distance_to_their_segment():
    assert margin(TRIPOD, (0.0, 0.0), (True, False, True)) == pytest.approx(-0.18)
    assert margin(TRIPOD, (0.0, 0.18), (True, False, True)) == pytest.approx(0.0)


def test_with_one_foot_the_margin_is_minus_the_distance_to_it():
    assert margin(TRIPOD, (0.0, 0.0), (False, True, False)) == pytest.approx(-0.12)


def test_with_no_foot_there_is_no_support_at_all():
    assert margin(TRIPOD, (0.0, 0.0), (False, False, False)) == -np.inf


def test_rows_are_judged_independently():
    rng = np.random.default_rng(4)
    points, weights = rng.normal(size=(50, 6, 2)), rng.normal(size=(50, 2))
    contact = rng.random((50, 6)) < 0.5
    together = stability_margin(points, contact, weights)
    alone = [margin(p, w, c) for p, w, c in zip(points, weights, contact, strict=True)]
    assert np.array_equal(together, alone)


@settings(deadline=None)  # the first case loads what it needs
@given(st.integers(0, 2**32 - 1))
def test_the_least_margin_is_that_of_looking_at_every_state(seed):
    random = np.random.default_rng(seed)
    steps = random.normal(size=(1000, 5, 2)) * 1e-3
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 1.5]]) + steps.cumsum(0)
    center = [0.5, 0.5] + (random.normal(size=(1000, 2)) * 1e-3).cumsum(0)
    contact = np.repeat(random.random((10, 5)) < 0.8, 100, axis=0)
    contact[~contact.any(axis=1)] = True
    least = LeastMargin()
    for part in np.split(np.arange(1000), [1, 130, 640]):
        least.see(points[part], contact[part], center[part])
    assert least.value == stability_margin(points, contact, center).min()
