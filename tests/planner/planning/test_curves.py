"""Curves that are given by formulas or by a table of poses, and their lengths."""

import re

import numpy as np
import pytest
import sympy as sp

from planner.planning.paths import (
    formula_curve,
    grid,
    line,
    recut,
    table_curve,
    waypoints,
)
from planner.systems.formulas import FUNCTIONS, read_formula, real_formula

S = np.array([0.0, 0.2, 0.5, 1.0])


def test_formulas_give_poses_and_those_missing_are_zero():
    path, length = formula_curve({"x": "s**2", "yaw": "pi*s"})
    assert path.at(S) == pytest.approx(np.stack([S**2, 0 * S, np.pi * S], axis=1))
    assert length == pytest.approx(1.0, rel=1e-9)
    assert path.at(S).dtype == float
    assert path.corners == ()


@pytest.mark.parametrize(
    ("formulas", "length"),
    [
        ({"x": "3*s", "y": "4*s"}, 5.0),
        ({"x": "cos(2*pi*s)", "y": "sin(2*pi*s)"}, 2 * np.pi),
        ({"yaw": "s"}, 0.0),
        ({"x": "s**2 - s"}, 0.5),  # there and back
    ],
)
def test_the_length_of_a_curve_is_that_of_its_positions(formulas, length):
    assert formula_curve(formulas)[1] == pytest.approx(length, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("formulas", "message"),
    [
        ({"x": True}, "x is True; write a formula of s"),
        ({"y": None}, "y is None; write a formula of s"),
        ({"x": "1/(s - 0.5)"}, "not finite at s = 0.5; keep it finite"),
        ({"x": "s/0"}, "not finite at s = 0; keep it finite"),
        ({"y": "log(0)*s"}, "not finite at s = 0; keep it finite"),
        ({"x": "(-8)**(1/3)*s"}, "not finite at s = 0; keep it finite"),
        ({"x": "s*sin(atan((-1)**pi))"}, "not finite at s = 0; keep it finite"),
        ({"x": "log(s, 2)"}, "formula 'log(s, 2)' has 'log(s, 2)'; functions take one"),
        ({"x": "s*(-pi)**pi"}, "not finite at s = 0; keep it finite"),
        (
            {"x": "+".join(["s/9"] * 480)},
            "formula 's/9+s/9+s/9+s/9+s/9+s/9+s/9+s/9+s/9",
        ),
        ({"x": f"s/{10**400}"}, f"formula 's/1{'0' * 54}...' cannot be read: int too"),
        ({"x": "s", "yaw": "sign(s - 0.3) + 1"}, "yaw jumps at s = 0.3; keep it cont"),
        ({"x": "atan2(s, 0)"}, "x jumps at s = 0; keep it continuous"),
        ({"x": "log(s)"}, "not finite at s = 0; keep it finite"),
        ({"x": "1/(s - 1)"}, "not finite at s = 1; keep it finite"),
        ({"x": "s + 1/(s - 0.123)"}, "not finite at s = 0.123; keep it finite"),
        ({}, "all poses are the same; let x, y or yaw change with s"),
        ({"x": 3, "yaw": "2"}, "all poses are the same; let x, y or yaw change with"),
    ],
)
def test_formulas_that_give_no_curve_are_refused(formulas, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        formula_curve(formulas)


POSES = [[0, 0, 0], [0.3, 0, 0.1], [0.3, 0, 0.1], [0.3, 0.4, 0.3], [0.2, 0.5, 0.3]]


def test_curves_with_bends_or_steep_slopes_are_as_long_as_they_are():
    _, bent = formula_curve({"x": "Abs(s - 0.3)", "y": "2*sign(s - 2)*s"})
    assert bent == pytest.approx(np.sqrt(5))
    _, steep = formula_curve({"x": "tanh(1e5*(s - 0.5005))"})
    assert steep == pytest.approx(2)
    gap = "sin(20*(s - 0.0625))/(s - 0.0625)"  # undefined between two places
    _, waves = formula_curve({"x": gap})
    places = np.linspace(0, 1, 100_001)
    swung = 20 * np.sinc(20 * (places - 0.0625) / np.pi)
    assert waves == pytest.approx(np.abs(np.diff(swung)).sum(), rel=1e-6)
    _, upright = formula_curve({"x": "sqrt(Abs(s - 0.5)) - sqrt(0.5)"})
    assert upright == pytest.approx(np.sqrt(2))


@pytest.mark.parametrize(
    "formula",
    [
        *(f"{name}(0.3 + s/2)" for name in FUNCTIONS if name != "atan2"),
        "atan2(s - 0.4, 0.2 - s**2)", "(1 + s)**-3 / (2 - s)", "s**s - 2**s + s**0.5",
        "-(s**2)*+3", "sqrt(0)*s + s*log(2**70)",
    ],
)  # fmt: skip
def test_formulas_in_numbers_are_those_in_symbols(formula):
    s = np.linspace(0.05, 0.95, 7)
    known = sp.lambdify(sp.Symbol("s"), read_formula(formula, [sp.Symbol("s")]))
    found = real_formula(formula, "s")(s)
    np.testing.assert_allclose(found, [float(known(one)) for one in s], rtol=1e-13)


def test_a_table_s_curve_passes_its_poses_in_proportion_to_their_distances():
    path, _ = table_curve(POSES)
    steps = np.linalg.norm(np.diff(POSES, axis=0), axis=1)
    where = np.append(0.0, np.cumsum(steps)) / steps.sum()
    assert path.at(where) == pytest.approx(np.array(POSES, dtype=float))


def test_a_table_s_curve_does_not_overshoot():
    path, length = table_curve(POSES)
    points = path.at(np.linspace(0, 1, 2001))
    assert points.max(axis=0) == pytest.approx([0.3, 0.5, 0.3])
    assert points.min(axis=0) == pytest.approx([0.0, 0.0, 0.0])
    chords = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1).sum()
    assert length == pytest.approx(chords, rel=1e-5)


def test_a_table_has_two_different_poses():
    with pytest.raises(ValueError, match="all poses are the same; give at least two"):
        table_curve([[1, 2, 3], [1, 2, 3]])
    path, length = table_curve([[0, 0, 0], [1, 0, 0]])
    assert path.at(S)[:, 0] == pytest.approx(S)
    assert length == pytest.approx(1.0)


def test_steps_that_rounding_swallows_are_left_out():
    poses = [[0, 0, 0], [0.001, 0, 0], [0.001, 1e-20, 0], [0.005, 0, 0]]
    path, length = table_curve(poses)
    assert length == pytest.approx(0.005)
    assert len(waypoints(poses).corners) == 1


def test_points_between_waypoints_lie_on_their_lines():
    points = np.array(
        [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 3.0], [0.0, 1.0, 3.0]]
    )
    path, s = waypoints(points), np.linspace(0, 1, 97)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    where = np.append(0, np.cumsum(lengths)) / lengths.sum()
    expected = [np.interp(s, where, column) for column in points.T]
    assert path.at(s) == pytest.approx(np.array(expected).T)
    assert path.corners == pytest.approx(where[1:-1])


def test_a_path_that_is_cut_anew_is_the_same_curve():
    bent = waypoints([[0, 0], [1, 0], [1, 3]])
    cuts = np.array([0.0, 0.1, 0.25, 0.9, 1.0])
    again = recut(bent, cuts)
    even = np.linspace(0, 1, 5)
    assert again.at(even) == pytest.approx(bent.at(cuts))
    assert again.at(even[:-1] + 0.125) == pytest.approx(
        bent.at((cuts[1:] + cuts[:-1]) / 2)
    )
    assert again.corners == (0.5,)
    assert recut(bent, np.array([0.0, 0.3, 1.0])).corners == ()


@pytest.mark.parametrize("segments", [3, 4, 6])
def test_every_corner_is_a_division_if_there_are_as_many(segments):
    corners = [0.02, 0.5, 0.98]
    path = waypoints([[s, k % 2 * 1e-6] for k, s in enumerate([0, *corners, 1])])
    cuts = grid(path, segments)
    assert len(cuts) == segments + 1
    kept = set(path.corners) <= set(cuts.tolist())
    assert kept == (segments >= 4)
    if not kept:
        assert cuts == pytest.approx(np.linspace(0, 1, 4))
    assert grid(line([0], [1]), segments) == pytest.approx(
        np.linspace(0, 1, segments + 1)
    )
