"""Which fields count as zero everywhere, and how far away that is looked at."""

import numpy as np
import pytest
import sympy as sp

from planner.systems.fields import sample_configurations
from planner.systems.rounding import vanishing

X, Y = STATE = sp.symbols("x y")
FARTHEST = 10 * np.abs(sample_configurations(2)).max()


@pytest.mark.parametrize(("share", "zero"), [(0.95, False), (1.05, True)])
def test_formulas_are_looked_at_ten_times_as_far_away_as_functions(share, zero):
    """Where a kink makes them differ from zero farther away alone."""
    late = sp.Max(0, sp.Abs(X) - share * FARTHEST, sp.Abs(Y) - share * FARTHEST)
    assert vanishing([sp.Matrix([late, 0])], STATE) == (zero,)


def test_a_dozen_configurations_within_a_unit_and_a_tenth_are_drawn():
    points = sample_configurations(40)
    assert points.shape == (12, 40)
    assert (points[6:] > 0).all()
    assert (points[:6] < 0).any()
    assert 1.0 < np.abs(points).max() <= 1.1


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_all_slopes_of_a_kink_but_the_first_vanish_beside_it(order):
    x = sp.Symbol("x", real=True)
    slope = sp.diff(sp.Abs(x), (x, order))
    assert vanishing([sp.Matrix([slope, 0])], (x, Y)) == (order > 1,)
