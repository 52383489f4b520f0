"""Values told apart from rounding: in any unit, through sums, products, functions."""

import numpy as np
import pytest
import sympy as sp

from planner.systems.fields import NumericField, lie_bracket
from planner.systems.rounding import WeighedValues, vanishing

ROUNDING = 1e-12

STATE = sp.symbols("x y")
X, Y = STATE
POINTS = np.random.default_rng(2).uniform(-1, 1, (6, 2))


def settled(formula, at):
    return WeighedValues(STATE, np.array([at], dtype=float))([formula])[0, 0]


@pytest.mark.parametrize(
    ("formula", "at"),
    [
        (sp.sin(X), (np.pi, 0)),
        (X - sp.Float(0.1) - sp.Float(0.2), (0.3, 0)),
        (sp.sin(X) ** 2 + sp.cos(X) ** 2 - 1, (1.234, 0)),
        (1e-20 * (sp.exp(X + Y) - sp.exp(X) * sp.exp(Y)), (0.7, 0.4)),
        (1e9 * (X - Y) * sp.cos(X), (0.1 + 0.2, 0.3)),
        (sp.atan2(sp.sin(X), Y), (np.pi, 1)),
        (sp.sin(1000 * X), (np.pi, 0)),
        (sp.Max(X - sp.Float(0.3), 0), (np.nextafter(0.3, 1), 0)),
        # what is negative weighs as much as what is positive
        (X + Y - sp.Float(3.3), (1.1, 2.2)),
        (X + Y + sp.Piecewise((-3.3, X < 2), (X, True)), (1.1, 2.2)),
        (sp.cos(X) - sp.cos(Y), (3.0, 2 * np.pi - 3.0)),
        (sp.sin(X), (-5e5 * np.pi, 0)),
    ],
)
def test_what_cancelling_terms_leave_is_zero(formula, at):
    assert settled(formula, at) == 0


@pytest.mark.parametrize(
    ("formula", "at", "value"),
    [
        (1e-30 * X, (0.5, 0), 5e-31),
        (X**12, (1e-3, 0), 1e-36),
        (sp.sin(X), (3.14159, 0), np.sin(3.14159)),
        (sp.Piecewise((1e-20, X < 2), (X, True)), (1, 0), 1e-20),
        (sp.sqrt(X - 5), (4, 0), np.nan),
    ],
)
def test_small_values_are_no_rounding(formula, at, value):
    # a handful of operations round by some 1e-16 each
    assert settled(formula, at) == pytest.approx(value, rel=1e-14, nan_ok=True)


def test_expanded_power_less_the_power_is_rounding_at_every_point():
    formula = sp.expand((X - 2 * Y) ** 8) - (X - 2 * Y) ** 8
    evaluation = WeighedValues(STATE, POINTS)
    assert not evaluation([formula]).any()
    # its terms add up to 3^8 in weight, so anything above this is told from them
    assert evaluation([formula + 1e5 * ROUNDING * sp.exp(X)]).all()


def test_noise_of_differences_is_rounding_and_brackets_are_not():
    first = NumericField(lambda x: [1.0, np.sin(x[0])])
    second = NumericField(lambda x: [0.0, 1.0])
    third = NumericField(lambda x: [0.0, x[0]])
    brackets = [lie_bracket(first, field, STATE) for field in (second, third)]
    assert vanishing(brackets, STATE) == (True, False)


@pytest.mark.parametrize(("size", "value"), [(0.9e-7, 0.0), (1.1e-7, 1.1e-7)])
def test_functions_are_judged_by_the_largest_terms_that_they_add_up(size, value):
    field = NumericField(lambda x: [3.0, size], terms=lambda x: 100 * x[0])
    points = np.array([[1.0, 0.0], [0.01, 0.0]])
    assert WeighedValues(STATE, points)(field).tolist() == [[3.0, value]] * 2


def test_fields_that_are_tiny_or_start_far_away_do_not_vanish():
    tiny = sp.ImmutableMatrix([1e-15 * X, 0])
    far = sp.ImmutableMatrix([sp.sqrt((X - 2) ** 2) + X - 2, 0])
    assert vanishing([tiny, far], STATE) == (False, False)
