"""Feet that bear the weight, planes through them, and the body that they move."""

from itertools import combinations

import numpy as np
import pytest

from models import Ground, load
from models.contact import UPRIGHT
from sim.logs.feet import Posture, _seen_from_plane, _shares, moved, posture
from sim.motion.poses import compose

LEAST_LIFT = 5e-4  # [m]
LIFTED = 0.02  # of the highest lift, from which on a foot is in the air

AROUND = np.arange(6) * np.pi / 3
HEXAGON = 0.1 * np.stack([np.cos(AROUND), np.sin(AROUND)], axis=1)
SQUARE = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]])


def standing(heights, center=(0.0, 0.0), places=SQUARE):
    """A posture whose feet are at heights (N, F), at the same places."""
    heights = np.atleast_2d(np.array(heights, dtype=float))
    flat = np.broadcast_to(places, (*heights.shape, 2))
    feet = np.concatenate([flat, heights[..., None]], axis=2)
    weight = np.tile([*center, 0.1], (len(heights), 1))
    return Posture(feet, weight, np.zeros_like(feet))


def test_shares_of_three_feet_balance_the_weight():
    rng = np.random.default_rng(2)
    feet, center = rng.normal(size=(5, 4, 3)), rng.normal(size=(5, 3))
    three = np.array([*combinations(range(4), 3)])
    found = _shares(feet, center, three)
    assert found.shape == (5, 4, 3)
    assert found.sum(axis=2) == pytest.approx(np.ones((5, 4)))
    for row, corners in enumerate(three):
        places = np.einsum("nk,nkc->nc", found[:, row], feet[:, corners, :2])
        assert places == pytest.approx(center[:, :2])


def test_feet_on_a_line_share_nothing():
    feet = np.array([[[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]])
    assert (_shares(feet, np.zeros((1, 3)), np.array([[0, 1, 2]])) == -1).all()


def test_heights_are_seen_from_the_plane_of_three_feet():
    slope, rng = np.array([0.2, -0.3]), np.random.default_rng(0)
    flat = rng.normal(size=(2, 5, 2))
    off = np.array([0.0, 0.0, 0.0, 0.4, -0.1])
    heights = flat @ slope + 0.7 + off
    feet = np.concatenate([flat, heights[..., None]], axis=2)
    tilt, above = _seen_from_plane(feet, np.array([[0, 1, 2]] * 2))
    assert tilt == pytest.approx(np.full(2, np.hypot(*slope)))
    assert above == pytest.approx(np.tile(off, (2, 1)))


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_foot_is_in_the_air_from_a_fiftieth_of_the_highest_lift_on(factor):
    high = 0.1
    found = standing(
        [[0.0, 0.0, 0.0, high]] * 3 + [[factor * LIFTED * high, 0, 0, 0]] * 3
    )
    assert found.near == pytest.approx(LIFTED * high)
    heights = [[0.0, factor * LIFTED * high, 0.0, high, 0.0, 0.0]]
    still = standing(heights * 4, places=HEXAGON)  # three others bear the weight
    assert still.standing[0].tolist() == [True, factor < 1, True, False, True, True]


def test_lifts_of_less_than_half_a_millimetre_are_none():
    found = standing([[0.0, 0.9 * LEAST_LIFT, 0.0, 0.0]] * 2)
    assert found.near == LEAST_LIFT
    assert found.standing.all()
    assert standing([[0.3, 0.301, 0.3, 0.5]]).height[0] == pytest.approx(
        [0, 0.001, 0, 0.2]
    )


def test_a_foot_that_rises_or_sinks_does_not_stand():
    """It is low enough for a moment, and moves as fast as any."""
    ramp = np.linspace(0, 0.1, 11)
    rising = np.zeros((11, 4))
    rising[:, 1] = ramp
    found = standing(rising, (0.02, -0.02)).standing
    assert not found[0, 1]
    assert found[:, [0, 2, 3]].all()


def test_the_weight_rests_on_the_lowest_triangle_around_it():
    """Three feet are low, but the weight is over the fourth, on the other side."""
    heights = [[0.0, 0.0, 0.0, 0.002]]
    leaning = standing(heights, (0.06, -0.04))
    assert leaning.standing[0].tolist() == [True, False, True, True]
    assert standing(heights, (-0.06, 0.04)).standing[0].tolist() == [
        True,
        True,
        True,
        False,
    ]


def test_moments_that_are_looked_at_in_blocks_are_told_as_all_together(monkeypatch):
    heights = np.random.default_rng(3).uniform(0.0, 0.003, (40, 4))
    together = standing(heights, (0.02, -0.01)).standing
    assert together.any(axis=1).all()
    assert not together.all()
    monkeypatch.setattr("sim.logs.feet.TOGETHER", 7)
    assert (standing(heights, (0.02, -0.01)).standing == together).all()


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_robot_that_would_lean_too_far_is_not_said_to_stand_so(share):
    high = share * np.tan(UPRIGHT) * np.hypot(0.1, 0.1)  # over the other corner
    found = standing([[0.0, 0.0, 0.0, high]], (0.06, -0.04)).standing[0]
    assert found.tolist() == (
        [True, False, True, True] if share < 1 else [True, True, True, False]
    )


@pytest.fixture(scope="module")
def hexapod():
    return load("hexapod")


def test_feet_of_a_robot_are_lifted_by_their_own_joints(hexapod):
    joints = hexapod.card.joints
    rest = np.array([hexapod.standing_angle(joint) for joint in joints])
    angles = np.tile(rest, (3, 1))
    lift = joints.index("lift_2")
    angles[1, lift] += 0.2
    angles[2, lift] += 1e-6
    found = posture(hexapod, joints, angles)
    assert found.height[0] == pytest.approx(np.zeros(6), abs=1e-9)
    raised = hexapod.legs.index(2)
    assert np.flatnonzero(found.height[1] > 0.01).tolist() == [raised]
    # what gives to a load at the sole, by its vertical part: a hinge alone has that
    upward = (found.feet[2, raised, 2] - found.feet[0, raised, 2]) / 1e-6
    assert found.gives[0, raised, 2] == pytest.approx(abs(upward), rel=1e-3)
    middle = found.feet[0, :, :2].mean(axis=0)
    assert found.center_of_mass[0, :2] == pytest.approx(middle, abs=5e-3)
    assert found.center_of_mass[0, 2] > 0


def test_feet_that_stroke_together_move_the_body_against_them(hexapod):
    """All feet go round and backward as one rigid shape: nothing slides."""
    joints = hexapod.card.joints
    rest = np.array([hexapod.standing_angle(joint) for joint in joints])
    still = posture(hexapod, joints, np.tile(rest, (6, 1)))
    step = np.array([0.004, -0.002, 0.01])
    poses = [np.zeros(3)]
    for _ in range(5):
        poses.append(compose(poses[-1], step))
    feet = still.feet.copy()
    for row, (x, y, yaw) in enumerate(poses):  # places that stay on the floor
        cos, sin = np.cos(yaw), np.sin(yaw)
        away = still.feet[0, :, :2] - [x, y]
        feet[row, :, :2] = away @ np.array([[cos, -sin], [sin, cos]])
    found = Posture(feet, still.center_of_mass, still.gives)
    below = Ground.of(hexapod, hexapod.model)
    for contact in (
        np.ones((6, 6), bool),
        np.tile([True, False, False, True, True, False], (6, 1)),
    ):
        pose, slip = moved(found, contact, below, 0.02)
        assert pose == pytest.approx(np.array(poses), abs=5e-5)
        assert slip.max() < 2e-4
        assert (slip[0] == 0).all()


def test_feet_in_the_air_neither_move_the_body_nor_slip(hexapod):
    joints = hexapod.card.joints
    rest = np.array([hexapod.standing_angle(joint) for joint in joints])
    still = posture(hexapod, joints, np.tile(rest, (4, 1)))
    feet = still.feet.copy()
    feet[:, 1, 0] += 0.01 * np.arange(4)
    found = Posture(feet, still.center_of_mass, still.gives)
    contact = np.ones((4, 6), bool)
    contact[:, 1] = False
    pose, slip = moved(found, contact, Ground.of(hexapod, hexapod.model), 0.02)
    assert np.abs(pose).max() < 1e-9
    assert slip.max() < 1e-9
    # a foot that lands stands from then on; before, feet stood without it
    contact[2:, 1] = True
    _, slip = moved(found, contact, Ground.of(hexapod, hexapod.model), 0.02)
    assert slip[2].max() < 1e-9
    assert slip[3, 1] > 5e-3
