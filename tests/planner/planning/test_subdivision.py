"""Subdividing by the square-root law: tubes that obey it, and what is refused."""

import numpy as np
import pytest

from planner.errors import BoundError
from planner.planning import subdivision as module
from planner.planning.paths import Path, grid, line, recut, waypoints
from planner.planning.subdivision import Slack, needed, refined, subdivide

ROOM = 0.05
WIDTH = 0.3  # of the tube of a segment as long as the path


def tube(cuts, room=ROOM, where=(0.0, 1.0)):
    """Slack of a walk whose tube obeys the law, and which needs room in one place."""
    middle, length = (cuts[:-1] + cuts[1:]) / 2, np.diff(cuts)
    inside = (middle > where[0]) & (middle < where[1])
    walking = np.where(inside, room - WIDTH * np.sqrt(length), 1.0)
    return [Slack("tube", 0.0, np.full(len(length), room), walking, unit="m")]


def test_a_tube_that_obeys_the_law_is_cut_to_the_critical_length():
    cuts = subdivide(np.array([0.0, 1.0]), tube)
    critical = (ROOM / WIDTH) ** 2
    assert np.diff(cuts).max() <= critical
    assert np.diff(cuts).min() > critical / 4  # at most cut in two once too often


def test_only_segments_that_leave_the_bound_are_cut():
    cuts = np.linspace(0, 1, 11)
    found = subdivide(cuts, lambda cuts: tube(cuts, where=(0.3, 0.5)))
    assert np.isin(cuts, found).all()
    outside = (found <= 0.3 + 1e-9) | (found >= 0.5 - 1e-9)
    assert found[outside] == pytest.approx(cuts[(cuts < 0.35) | (cuts > 0.45)])
    assert len(found) > len(cuts)


def test_a_bound_that_is_kept_changes_nothing():
    cuts = np.linspace(0, 1, 5)
    assert subdivide(cuts, lambda cuts: tube(cuts, room=1.0)) is cuts


def test_the_tightest_of_several_bounds_decides():
    both = subdivide(np.array([0.0, 1.0]), lambda c: tube(c, 0.2) + tube(c, 0.1))
    alone = subdivide(np.array([0.0, 1.0]), lambda c: tube(c, 0.1))
    assert both == pytest.approx(alone)


def test_needed_pieces_follow_the_square_of_what_swings_out():
    walking = np.array([0.1, -0.3, -0.6])
    slack = Slack("tube", 0.0, np.ones(3), walking)
    assert needed(slack).tolist() == [1, 2, 3]
    assert needed(slack._replace(walking=20 * walking)).max() == 3


def test_refining_keeps_the_cuts_there_are():
    cuts = refined(np.array([0.0, 0.5, 1.0]), np.array([1, 5]))
    assert cuts == pytest.approx([0, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])


def test_too_many_segments_are_refused_with_what_can_be_kept(monkeypatch):
    monkeypatch.setattr(module, "MOST_DIVIDED", 50)
    with pytest.raises(
        BoundError,
        match=r"tube of 0 m would need more than 50 segments, above all between "
        r"s = 0 and 0\.\d+ of the path; -0\.\d+ m is kept with 27: ask for less",
    ):
        subdivide(np.array([0.0, 1.0]), lambda cuts: tube(cuts, room=0.01))


def test_a_path_that_is_too_long_for_the_legs_is_refused_as_such(monkeypatch):
    monkeypatch.setattr(module, "MOST_DIVIDED", 50)

    def reach(cuts):
        left = 0.01 - np.diff(cuts)
        return [Slack("joint range", 0.0, np.full(len(left), 0.01), left, law=1.0)]

    message = "the joint range needs more than 50 segments, .*; give a shorter path"
    with pytest.raises(BoundError, match=message):
        subdivide(np.array([0.0, 1.0]), reach)


def test_dividing_a_recut_path_evenly_divides_the_path_at_the_cuts():
    path = waypoints([(0, 0), (1, 0), (1, 1)])
    cuts = np.array([0, 0.1, 0.2, 0.5, 0.75, 1.0])
    again = recut(path, cuts)
    even = grid(again, 5)
    assert even == pytest.approx(np.linspace(0, 1, 6))
    assert again.at(even) == pytest.approx(path.at(cuts))
    assert again.corners == pytest.approx((3 / 5,))


def test_corners_between_cuts_do_not_draw_them():
    path = waypoints([(0, 0), (1, 0), (1, 1)])
    again = recut(path, np.array([0, 0.2, 0.45, 1.0]))
    assert again.at(grid(again, 3)) == pytest.approx(
        path.at(np.array([0, 0.2, 0.45, 1]))
    )


def test_what_grows_with_the_length_itself_is_cut_in_proportion():
    slack = Slack("range", 0.0, np.ones(2), np.array([-1.0, -2.0]), law=1.0)
    assert needed(slack).tolist() == [2, 3]


def test_a_recut_path_is_the_same_curve():
    path, s = line((0, 0), (3, 4)), np.linspace(0, 1, 50)
    again = recut(path, np.array([0.0, 0.7, 1.0]))
    assert isinstance(again, Path)
    points = again.at(s)
    assert points[[0, -1]] == pytest.approx(path.at(np.array([0.0, 1.0])))
    assert points[:, 1] * 3 == pytest.approx(points[:, 0] * 4)
    assert (np.diff(points[:, 0]) > 0).all()
