"""Deviation from a path whose points are passed in order."""

import numpy as np
import pytest

from planner.optimisation.corridor import (
    Tolerance,
    _frechet,
    _reachable,
    deviation,
    gaps,
)

POSITION, YAW = (0, 1), (2,)


def along(x, y=0.0, yaw=0.0):
    x = np.asarray(x, dtype=float)
    return np.stack([x, np.broadcast_to(y, x.shape), np.broadcast_to(yaw, x.shape)], 1)


PATH = along(np.linspace(0.0, 1.0, 1001))


def test_a_motion_beside_the_path_deviates_by_its_distance():
    states = along(np.linspace(0.0, 1.0, 50), y=0.3, yaw=0.2)
    position, yaw = deviation(states, PATH, [POSITION, YAW])
    assert position == pytest.approx(0.3, abs=2e-4)  # states are 0.02 apart
    assert yaw == pytest.approx(0.2)


def test_going_back_costs_half_the_way_back():
    x = np.concatenate([np.linspace(0, 0.8, 81), np.linspace(0.8, 0.4, 41)[1:]])
    states = along(np.concatenate([x, np.linspace(0.4, 1.0, 61)[1:]]))
    (position,) = deviation(states, PATH, [POSITION])
    assert position == pytest.approx(0.2, abs=1e-3)  # a point half a way back waits


def test_a_jump_of_one_in_every_coordinate_counts():
    states = np.array([[0.0, 0, 0], [1, 1, 1], [0, 0, 0]])
    found = deviation(states, np.zeros((5, 3)), [POSITION, YAW])
    assert found == pytest.approx((np.sqrt(2), 1.0))


def test_states_that_stand_still_change_nothing():
    states = along(np.linspace(0.0, 1.0, 50), y=0.3, yaw=0.2)
    slow = np.repeat(states, 3, axis=0)
    groups = [POSITION, YAW]
    assert deviation(slow, PATH, groups) == deviation(states, PATH, groups)


def test_gaps_say_which_state_is_how_far_off():
    y = np.where(np.arange(50) == 20, 0.3, 0.1)
    found = gaps(along(np.linspace(0, 1, 50), y=y, yaw=0.2), PATH, [POSITION, YAW])
    assert found.shape == (50, 2)
    assert found[:, 0] == pytest.approx(y, abs=1e-4)  # points are 0.001 apart
    assert found[:, 1] == pytest.approx(0.2)


def test_standing_still_does_not_follow_a_closed_path():
    turn = np.linspace(0, 2 * np.pi, 1001)
    circle = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    states = np.repeat(circle[:1], 5, axis=0)
    (position,) = deviation(states, circle, [POSITION])
    assert position == pytest.approx(2.0, abs=1e-4)


def test_leaving_out_a_part_of_the_path_counts():
    spike = np.vstack([along(np.linspace(0, 0.5, 501)), along(np.full(300, 0.5))])
    spike[501:, 1] = np.concatenate(
        [np.linspace(0, 0.4, 150), np.linspace(0.4, 0, 150)]
    )
    path = np.vstack([spike, along(np.linspace(0.5, 1.0, 501))])
    (position,) = deviation(PATH, path, [POSITION])
    assert position == pytest.approx(0.4, abs=2e-3)


def test_yaw_is_compared_at_the_nearest_point():
    path = along(np.linspace(0, 1, 1001), yaw=np.linspace(0, 1, 1001))
    states = along([0.0, 0.25, 0.5, 0.75, 1.0], y=0.1, yaw=[0.0, 0.25, 0.9, 0.75, 1.0])
    _, yaw = deviation(states, path, [POSITION, YAW])
    assert yaw == pytest.approx(0.4, abs=1e-3)


@pytest.mark.parametrize("most", [0.0, -1.0, float("nan")])
def test_tolerances_are_above_zero(most):
    with pytest.raises(ValueError, match="tolerance is"):
        Tolerance((0,), most)


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (6, 1), (4, 7), (7, 4)])
def test_the_frechet_distance_is_the_least_of_all_couplings(shape):
    """Both go on by a point at a time, one of them or both; it is their largest gap."""
    apart = np.random.default_rng(5).uniform(size=shape)

    def least(i, j):
        if i < 0 or j < 0:
            return np.inf
        ways = [least(i - 1, j), least(i, j - 1), least(i - 1, j - 1)]
        return max(apart[i, j], min(ways) if i or j else 0.0)

    rows, columns = shape
    most = least(rows - 1, columns - 1)
    assert _frechet(apart) == most
    assert _reachable(apart, most)[-1, -1]
    assert not _reachable(apart, most * (1 - 1e-3))[-1, -1]


def test_a_companion_is_reached_where_the_way_to_it_is_short_enough():
    apart = np.random.default_rng(6).uniform(size=(6, 7))
    for most in (0.5, 0.7, 0.9):
        expected = np.zeros(apart.shape, dtype=bool)
        for i, j in np.ndindex(apart.shape):
            before = [(i - 1, j), (i, j - 1), (i - 1, j - 1)]
            inside = [expected[at] for at in before if min(at) >= 0]
            expected[i, j] = apart[i, j] <= most and (any(inside) or i == j == 0)
        assert _reachable(apart, most).tolist() == expected.tolist()
