"""What distances are weighed by: ways of played motions, and scales of walks."""

from math import pi

import numpy as np
import pytest

from sim.evaluation.deviations import Scale, departure, off, per_metre, predicted_way
from sim.scenarios.body_path import line

SWAY = 0.25  # of the feet's distance from the middle
DEGREE = pi / 180  # of yaw, as good as there
NEAR = 0.02  # of the path: with yaw within a degree, as good as there

REACH = 0.1  # mean distance of the feet [m]
RIGHT = np.linspace(0.0, 1.0, 401)


def poses(x=0.0, y=0.0, yaw=0.0):
    """Poses in time order, of coordinates that are numbers or rows."""
    return np.stack([*np.broadcast_arrays(x, y, yaw, RIGHT)[:3]], axis=1)


@pytest.mark.parametrize(
    ("motion", "length"),
    [
        (poses(x=RIGHT), 1.0),
        (poses(x=0.6 * RIGHT, y=-0.8 * RIGHT), 1.0),
        (poses(y=0.02 * np.sin(40 * RIGHT)), 0.02 * np.sin(40)),  # swaying is no way
        (poses(x=0.0009 * RIGHT), 0.0),  # less than a hundredth
        (poses(x=0.0011 * RIGHT), 0.0011),
        (poses(yaw=-4 * pi * RIGHT), REACH * 4 * pi),  # of the feet, twice around
        (poses(yaw=4 * pi * RIGHT + pi), REACH * 4 * pi),
        (poses(x=RIGHT, yaw=RIGHT), 1.0),  # whichever is longer
    ],
)
def test_the_way_of_a_played_motion_is_its_body_s_or_its_feet_s(motion, length):
    wrapped = motion.copy()
    wrapped[:, 2] = (wrapped[:, 2] + pi) % (2 * pi) - pi  # as poses are told
    assert predicted_way(wrapped, REACH) == pytest.approx(abs(length), abs=1e-9)


@pytest.mark.parametrize(("apart", "ways"), [(0.99 * SWAY, 1), (1.01 * SWAY, 3)])
def test_swaying_is_a_way_from_a_quarter_of_the_feet_s_distance_on(apart, ways):
    there_and_back = np.zeros((4, 3))
    there_and_back[[1, 3], 1] = apart * REACH
    assert predicted_way(there_and_back, REACH) == pytest.approx(ways * apart * REACH)


def test_where_a_way_turns_back_no_more_is_cut_than_counts_as_swaying():
    there_and_back = poses(x=np.abs(2 * RIGHT - 1))
    assert 2.0 - 2 * SWAY * REACH < predicted_way(there_and_back, REACH) <= 2.0


def test_a_pose_is_apart_from_another_by_distance_and_the_nearer_turn():
    apart = departure(np.array([3.0, 4.0, 3.0]), np.array([0.0, 0.0, -3.0]))
    assert (apart.position, apart.yaw) == pytest.approx((5.0, 2 * pi - 6))


def test_errors_are_shares_of_path_and_way_where_these_have_a_length():
    there, other = poses(x=RIGHT), poses(x=RIGHT, y=RIGHT * (1 - RIGHT) + 0.1 * RIGHT)
    error = off(there, other, length=2.0, walked=4.0)
    assert (error.position, error.yaw) == pytest.approx((0.1, 0.0))
    assert error.position_per_path == pytest.approx(0.05)
    assert error.position_per_walked == pytest.approx(0.025)
    assert error.farthest == pytest.approx(0.55**2, abs=1e-5)  # of s (1 - s) + s / 10
    none = off(there, other, length=0.0, walked=1e-9)
    assert (none.position_per_path, none.position_per_walked) == (None, None)


def test_time_and_strokes_per_metre_are_none_of_no_path():
    some = per_metre(2.0, 10.0, 6.0)
    assert (some.seconds, some.strokes) == (5.0, 3.0)
    for length, seconds in ((0.0, 10.0), (2e-6, 3e3)):  # files have numbers below 1e9
        none = per_metre(length, seconds, 6.0)
        assert (none.seconds, none.strokes) == (None, None)


def test_a_turn_on_the_spot_is_as_long_as_the_way_of_its_feet():
    only_turns = Scale.of(line((0.0, 0.0, -pi / 2)), REACH, ["ideal"])
    assert only_turns.length == pytest.approx(REACH * pi / 2)
    rounded = line((6.1e-18, 0.0, -pi / 2))  # by a cosine of pi / 2
    assert (rounded.length, Scale.of(rounded, REACH, ["ideal"])) == (0.0, only_turns)
    ahead = Scale.of(line((0.3, 0.4, 1.0)), REACH, ["ideal"])
    assert ahead.length == pytest.approx(0.5)
    assert Scale.of(line((1e-9, 0.0, 0.0)), REACH, ["ideal"]).length == 0  # rounding


def test_yaw_counts_at_the_feet_and_near_the_end_not_at_all():
    scale = Scale("ideal", REACH, 2.0)
    here, there = np.zeros(3), np.array([0.03, 0.04, 0.5])
    assert scale.share(here, there) == pytest.approx(np.hypot(0.05, 0.05) / 2)
    assert scale.share(here, there, near=True) == pytest.approx(0.05 / 2)
    assert Scale("ideal", REACH, 0.0).share(here, there) == 0.0


@pytest.mark.parametrize(
    ("aside", "turned", "near"),
    [(0.9, 0.9, True), (1.1, 0.9, False), (0.9, 1.1, False)],
)
def test_an_end_is_near_within_both_a_share_of_the_length_and_an_angle(
    aside, turned, near
):
    scale = Scale("ideal", REACH, 2.0)
    end = np.array([[0.0, 0.0, 0.0], [1.0, 2.0 * NEAR * aside, DEGREE * turned]])
    predicted = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    found = scale.weigh(end, predicted, goal=(1.0, 0.0, 0.0))
    yaw = 0.0 if near else REACH * DEGREE * turned
    assert found.ended == pytest.approx(np.hypot(2.0 * NEAR * aside, yaw) / 2)
    assert found.goal == found.farthest == found.ended
    assert scale.weigh(end, predicted, None).goal is None
