"""Where what a real robot measured is turned, counted and averaged, or not."""

from dataclasses import replace
from math import degrees, pi, radians

import numpy as np
import pytest

from sim.logs.alignment import measured, together
from sim.logs.log import Log

TIME = np.linspace(0, 2, 41)


WAY = np.stack([0.1 * TIME, 0 * TIME, 0 * TIME], axis=1)


def posed(pose, **parts):
    return Log(TIME, ("hip",), np.zeros((41, 1)), pose=pose, **parts)


@pytest.mark.parametrize("angle", [4.9, -4.9, 5.1, -5.1])
def test_a_frame_that_is_turned_by_five_degrees_is_turned_back(angle):
    a = radians(angle)
    turned = np.stack(
        [0.1 * TIME * np.cos(a), 0.1 * TIME * np.sin(a), 0 * TIME], axis=1
    )
    seen = measured(posed(turned), TIME, WAY)
    if abs(angle) > 5:
        np.testing.assert_allclose(seen.pose, WAY, atol=1e-12)
        assert f"is turned by {angle:.1f} degrees against the robot" in seen.done[0]
    else:
        np.testing.assert_allclose(seen.pose, turned, atol=1e-12)
        assert seen.done == ()


@pytest.mark.parametrize("way", [0.009, 0.011])
def test_of_a_motion_of_less_than_a_centimetre_no_direction_is_known(way):
    part = TIME / 2
    ahead, left = way * np.stack([part, 0 * part]), way * np.stack([0 * part, part])
    poses = [np.column_stack([*xy, 0 * TIME]) for xy in (ahead, left)]
    seen = measured(posed(poses[1]), TIME, poses[0])
    best = poses[0] if way > 0.01 else poses[1]
    np.testing.assert_allclose(seen.pose, best, atol=1e-12)


@pytest.mark.parametrize(
    ("first", "said"),
    [
        ((0.007, 0.007, 0.0), False),
        ((0.008, 0.008, 0.0), True),
        ((0.0, 0.0, radians(4.9)), False),
        ((0.0, 0.0, -radians(5.1)), True),
        ((0.0, 0.0, 2 * pi - radians(1)), False),
    ],
)
def test_a_first_pose_away_from_the_origin_is_told(first, said):
    x, y, yaw = first
    cos, sin = np.cos(yaw), np.sin(yaw)
    seen = WAY @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]]) + first
    found = measured(posed(seen), TIME, WAY)
    np.testing.assert_allclose(found.pose, WAY, atol=1e-12)
    told = [line for line in found.done if "counted from the first" in line]
    assert len(told) == said
    if said:
        assert f"({x:.3g}, {y:.3g}) m and {degrees(yaw):.1f} degrees" in told[0]


@pytest.mark.parametrize("apart", [0.99, 1.01])
def test_commands_of_trials_may_differ_by_a_degree(apart):
    other = replace(posed(WAY), commanded=np.full((41, 1), -radians(apart)))
    done = together([posed(WAY), other]).done
    assert len(done) == 1 + (apart > 1)
    assert done[-1] == "mean of 2 trials, with its standard error"


def test_a_mean_needs_two_trials_with_a_pose():
    alone = together([posed(WAY), replace(posed(WAY), pose=None)])
    none = "trial 2 has no body.x, body.y, body.yaw, and is left out beside those"
    assert alone.done == (f"{none} that have",)
    assert alone.spread is None
    np.testing.assert_array_equal(alone.pose, WAY)
    assert together([posed(WAY)]).done == ()


def test_joints_of_trials_are_compared_by_their_names():
    two = np.stack([0.1 * TIME, -0.2 * TIME], axis=1)
    one = Log(TIME, ("a", "b"), two, pose=WAY)
    other = Log(TIME, ("b", "a"), two[:, ::-1], pose=WAY)
    assert len(together([one, other]).done) == 1


def test_yaw_of_trials_is_averaged_beyond_half_a_turn():
    turning = np.stack([0 * TIME, 0 * TIME, 2 * TIME], axis=1)
    wrapped = turning.copy()
    wrapped[:, 2] = (turning[:, 2] + pi) % (2 * pi) - pi
    mean = together([posed(turning), posed(wrapped)])
    np.testing.assert_allclose(mean.pose, turning, atol=1e-12)
    np.testing.assert_allclose(mean.spread, 0.0, atol=1e-12)


def test_an_angle_with_gaps_in_it_is_bridged_and_none_without_numbers_is_told():
    lean = np.stack([0.1 * TIME, np.full(41, np.nan)], axis=1)
    lean[3:6, 0] = np.nan
    found = measured(posed(None, lean=lean), TIME, WAY)
    assert [*found.lean] == ["roll"]
    np.testing.assert_allclose(found.lean["roll"], 0.1 * TIME, atol=1e-12)
    assert measured(posed(None, contact={1: np.ones(41)}), TIME, WAY).pose is None
    assert found.arrays.keys() == {"roll"}
    both = measured(posed(WAY, lean=0 * WAY[:, :2]), TIME, WAY)
    assert both.arrays.keys() == {"pose", "roll", "pitch"}
