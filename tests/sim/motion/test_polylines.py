"""Length along a line, and points about evenly apart on it."""

import numpy as np
import pytest

from sim.motion.poses import length_up_to, spaced_rows

CORNER = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [3.0, 4.0]])


def test_lengths_begin_at_zero_and_count_every_piece():
    assert length_up_to(CORNER) == pytest.approx([0, 3, 7, 7])


def test_points_that_are_closer_than_the_spacing_are_passed_over():
    dense = np.stack([np.arange(0, 1.05, 0.1), np.zeros(11)], axis=1)
    assert list(spaced_rows(dense, 0.35)) == [0, 4, 7]
    assert list(spaced_rows(dense, 0.05)) == list(range(11))
    assert list(spaced_rows(np.zeros((5, 2)), 0.1)) == [0]
