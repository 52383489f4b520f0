"""Planar poses."""

import numpy as np
import pytest

from sim.motion.poses import nearest_turn, pose_of, seen_from, wrap


def test_angles_are_wrapped_to_minus_pi_excluded_pi_included():
    assert wrap(np.pi) == np.pi
    assert wrap(-np.pi) == np.pi
    assert wrap(3 * np.pi / 2) == pytest.approx(-np.pi / 2)
    assert wrap(np.array([0.3, 7.0])) == pytest.approx([0.3, 7.0 - 2 * np.pi])


def test_yaw_is_read_from_the_quaternion_of_the_free_joint():
    qpos = np.array([0.1, 0.2, 0.3, np.cos(0.4), 0.0, 0.0, np.sin(0.4), 9.0])
    assert pose_of(qpos, 0) == pytest.approx([0.1, 0.2, 0.8])


def test_a_pose_seen_from_itself_is_the_origin():
    pose = np.array([0.3, -0.2, 2.5])
    assert seen_from(pose, pose) == pytest.approx(np.zeros(3))


def test_one_step_ahead_is_forward_whatever_the_heading():
    for yaw in (0.0, 1.0, 3.0, -3.0):
        origin = np.array([1.0, 2.0, yaw])
        ahead = origin + [np.cos(yaw), np.sin(yaw), 0.5]
        assert seen_from(origin, ahead) == pytest.approx([1.0, 0.0, 0.5])


def test_the_nearest_turn_follows_a_yaw_beyond_half_a_turn():
    assert nearest_turn(-3.0, 3.2) == pytest.approx(-3.0 + 2 * np.pi)
    assert nearest_turn(0.1, 0.0) == pytest.approx(0.1)
