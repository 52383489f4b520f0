"""Static loads: equilibrium, and springs that push but never pull."""

import numpy as np
import pytest

from models.contact.loads import static_loads

TRIANGLE = np.array([[0.15, 0.18], [0.0, -0.12], [-0.15, 0.18]])
SQUARE = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])


def test_three_feet_balance_weight_and_moments():
    center = np.array([[0.01, 0.02]])
    loads = static_loads(TRIANGLE[None], center)[0]
    assert loads.sum() == pytest.approx(1.0)
    assert loads @ TRIANGLE == pytest.approx(center[0])


def test_the_middle_foot_of_a_tripod_carries_three_fifths():
    loads = static_loads(TRIANGLE[None], np.zeros((1, 2)))[0]
    assert loads == pytest.approx([0.2, 0.6, 0.2])


def test_more_feet_share_as_equal_springs_do():
    center = np.array([[0.0, 0.0], [0.2, 0.0]])
    loads = static_loads(np.stack([SQUARE, SQUARE]), center)
    assert loads[0] == pytest.approx([0.25] * 4)
    assert loads[1] == pytest.approx([0.3, 0.3, 0.2, 0.2])


def test_no_foot_pulls():
    loads = static_loads(SQUARE[None], np.array([[0.6, 0.6]]))[0]
    assert loads.min() == 0.0
    assert loads @ SQUARE == pytest.approx([0.6, 0.6])


def test_two_feet_share_by_their_distances():
    feet = np.array([[[1.0, 0.0], [-1.0, 0.0]]])
    assert static_loads(feet, np.array([[0.5, 0.0]]))[0] == pytest.approx([0.75, 0.25])
