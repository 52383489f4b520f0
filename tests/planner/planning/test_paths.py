"""Nominal paths, and how they are cut into segments."""

import numpy as np
import pytest

from planner.planning.paths import (
    as_path,
    ellipse,
    ellipse_perimeter,
    grid,
    line,
    waypoints,
)


def test_line_is_straight_and_meets_both_ends():
    path = line([1.0, 2, 3], [2.0, 4, 6])
    assert path.at(np.array([0, 0.25, 1])).tolist() == [
        [1, 2, 3],
        [1.25, 2.5, 3.75],
        [2, 4, 6],
    ]


def test_heading_is_not_wrapped():
    assert line([0, 0, 0], [0, 0, 20.0])(1.0)[2] == 20.0


def test_ellipse_is_that_of_figure_7():
    s = np.linspace(0, 1, 9)
    x, y, heading = ellipse([0, 0, 0.5], (0.10, 0.06)).at(s).T
    assert ((x + 0.10) / 0.10) ** 2 + (y / 0.06) ** 2 == pytest.approx(np.ones(9))
    assert x[[0, -1]] == pytest.approx([0, 0])
    assert y[2] == pytest.approx(0.06)
    assert set(heading) == {0.5}


def test_waypoints_are_passed_in_proportion_to_length():
    path = waypoints([[0, 0], [3, 0], [3, 1]])
    assert path.corners == (0.75,)
    assert path.at(np.array([0.375, 0.75, 1])).tolist() == [[1.5, 0], [3, 0], [3, 1]]


def test_repeated_waypoints_are_passed_over():
    assert waypoints([[0, 0], [0, 0], [1, 0], [1, 0]]).corners == ()


def test_waypoints_without_length_stay():
    assert waypoints([[1, 2], [1, 2]])(0.7).tolist() == [1, 2]


def test_divisions_are_uniform_but_for_corners():
    straight, bent = line([0], [1]), waypoints([[0, 0], [0.33, 0], [0.33, 0.67]])
    assert grid(straight, 4).tolist() == [0, 0.25, 0.5, 0.75, 1]
    assert grid(bent, 4) == pytest.approx([0, 0.33, 0.5, 0.75, 1])
    assert grid(bent, 1).tolist() == [0, 1]


@pytest.mark.parametrize("corner", [0.38, 0.45, 0.55, 0.62])
def test_a_corner_draws_the_division_nearest_to_it(corner):
    bent = waypoints([[0, 0], [corner, 0], [corner, 1 - corner]])
    # of 0.25, 0.5 and 0.75 the middle one
    assert grid(bent, 4) == pytest.approx([0, 0.25, corner, 0.75, 1])


@pytest.mark.parametrize(
    "corners", [[0.3, 0.31, 0.32], [0.01, 0.02, 0.03], [0.2, 0.98, 0.99], [0.5, 0.6]]
)
@pytest.mark.parametrize("segments", [4, 5, 9])
def test_close_corners_are_all_divisions(corners, segments):
    path = waypoints([[s, k % 2 * 1e-6] for k, s in enumerate([0, *corners, 1])])
    cuts = grid(path, segments)
    assert set(path.corners) < set(cuts.tolist())
    assert (np.diff(cuts) > 0).all()


def test_function_is_called_once_a_parameter():
    path = as_path(lambda s: [s, 2 * s])
    assert path.at(np.array([0, 0.5])).tolist() == [[0, 0], [0.5, 1]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: waypoints([[0, 0]]), "at least 2 points, got 1"),
        (
            lambda: line([0, 0], [1, 2, 3]),
            r"point 2 has shape \(3,\), the first",
        ),
        (lambda: line([0, 0], [1, np.inf]), r"point 2 is not finite: \[1.0, inf\]"),
        (lambda: ellipse([0], (1, 1)), "needs two coordinates, got 1"),
        (lambda: line(["0", "0"], [1, 2]), "coordinates are of type <U1; give real"),
        (lambda: line([0, None], [1, 2]), "coordinates are of type object; give real"),
        (lambda: line([0, 0], [1, 2])(None), "parameters are of type object; give"),
        (lambda: line([0, 0], [1, 2])(0.5j), "parameters are of type complex128"),
    ],
)
def test_unsound_paths_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_perimeter_of_an_ellipse_is_the_length_of_its_path():
    """Gauss's quadrature of the speed; a circle's is known."""
    assert ellipse_perimeter((0.5, 0.5)) == pytest.approx(np.pi, rel=1e-15)
    angles, weights = np.polynomial.legendre.leggauss(60)
    angles = np.pi / 4 * (angles + 1)
    speed = np.hypot(0.1 * np.sin(angles), 0.06 * np.cos(angles))
    around = 4 * np.pi / 4 * weights @ speed
    assert ellipse_perimeter((0.1, 0.06)) == pytest.approx(around, rel=1e-14)
    assert ellipse_perimeter((0.06, 0.1)) == ellipse_perimeter((0.1, 0.06))


def test_a_function_may_fill_the_same_array_at_every_call():
    buffer = np.zeros(2)

    def path(s):
        buffer[:] = s, 2 * s
        return buffer

    assert as_path(path).at(np.array([0.25, 1.0])).tolist() == [[0.25, 0.5], [1, 2]]
