"""Rates of functions along fields are sympy's own derivatives, found sooner."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import PlannerError
from planner.planning.rates import declared_or_derived, rate_along, vanishes
from planner.systems.fields import sample_configurations
from tests.systems import THETA, X, Y

STATE = (X, Y, THETA)
FIELD = sp.Matrix([sp.cos(THETA), X * Y, 2])
FUNCTIONS = [
    X,
    sp.Integer(3),
    X * Y * THETA,
    (1 + X**2) ** 3,
    sp.tan(THETA) / (2 + sp.cos(X)),
    (2 + X) ** Y,
    sp.atan2(Y + 3, X + 3),
    sp.Symbol("parameter") * Y,
]


@pytest.mark.parametrize("function", FUNCTIONS, ids=str)
def test_a_rate_is_the_sum_of_slopes_times_velocities(function):
    expected = sum(function.diff(x) * v for x, v in zip(STATE, FIELD, strict=True))
    found = rate_along(function, FIELD, STATE)
    difference = sp.lambdify(
        (*STATE, sp.Symbol("parameter")), sp.sympify(found) - expected
    )
    for x in 0.3 * sample_configurations(3):
        assert difference(*x, 0.7) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("expression", "size", "is_zero"),
    [
        (sp.sin(X) ** 2 + sp.cos(X) ** 2 - 1, 1.0, True),
        (1e-6 * X, 1.0, False),
        (1e-6 * X, 1e4, True),  # a size of what is compared
        (sp.Integer(0), 1.0, True),
        (sp.log(-1 - X**2), 1.0, True),  # nowhere finite: nothing speaks against it
    ],
)
def test_an_expression_vanishes_relative_to_a_size(expression, size, is_zero):
    assert vanishes(expression, STATE, size) is is_zero


def test_a_declared_rate_stands_if_it_is_the_derived_one():
    derived, short = 2 * sp.sin(X) * sp.cos(X), sp.sin(2 * X)
    assert declared_or_derived(derived, short, STATE) is short
    assert declared_or_derived(derived, None, STATE) is derived
    with pytest.raises(PlannerError, match="is not the rate that the fields give"):
        declared_or_derived(derived, short + 1e-3 * Y, STATE)
    large = 1e9 * derived + np.pi  # relative to what it comes to
    assert declared_or_derived(large, large + 1e-3, STATE) == large + 1e-3
