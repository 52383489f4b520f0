"""Planar poses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.motion.poses import lean_of, pose_of, seen_from, wrap


def test_angles_are_wrapped_to_minus_pi_excluded_pi_included():
    assert wrap(np.pi) == np.pi
    assert wrap(-np.pi) == np.pi
    assert wrap(3 * np.pi / 2) == pytest.approx(-np.pi / 2)
    assert wrap(np.array([0.3, 7.0])) == pytest.approx([0.3, 7.0 - 2 * np.pi])


def test_yaw_is_read_from_the_quaternion_of_the_free_joint():
    qpos = np.array([0.1, 0.2, 0.3, np.cos(0.4), 0.0, 0.0, np.sin(0.4), 9.0])
    assert pose_of(qpos, 0) == pytest.approx([0.1, 0.2, 0.8])


def test_a_body_that_is_turned_pitched_and_rolled_has_that_yaw_and_lean():
    rng = np.random.default_rng(2)
    yaw, pitch, roll = rng.uniform(-1.5, 1.5, (3, 20))
    turned = Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], axis=1))
    qpos = rng.normal(size=(20, 11))
    qpos[:, 5:9] = turned.as_quat(scalar_first=True)
    assert lean_of(qpos, 2) == pytest.approx(np.stack([roll, pitch], axis=1))
    found = np.stack([pose_of(each, 2) for each in qpos])
    assert found == pytest.approx(np.stack([qpos[:, 2], qpos[:, 3], yaw], axis=1))


def test_a_pose_seen_from_itself_is_the_origin():
    pose = np.array([0.3, -0.2, 2.5])
    assert seen_from(pose, pose) == pytest.approx(np.zeros(3))


def test_one_step_ahead_is_forward_whatever_the_heading():
    for yaw in (0.0, 1.0, 3.0, -3.0):
        origin = np.array([1.0, 2.0, yaw])
        ahead = origin + [np.cos(yaw), np.sin(yaw), 0.5]
        assert seen_from(origin, ahead) == pytest.approx([1.0, 0.0, 0.5])
