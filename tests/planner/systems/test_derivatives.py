"""Derivatives, brackets and ranks of fields, and level sets that they leave."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import FieldError
from planner.numerics.subspaces import in_words, nearly_dependent, rank
from planner.systems import closure
from planner.systems.closure import exact_rank, involutive_closure
from planner.systems.fields import (
    NumericField,
    as_numeric,
    central_difference,
    lie_bracket,
    sample_configurations,
)
from planner.systems.level_sets import LevelSet

SPANNED = 1e-8  # relative singular values above it count towards the rank
DIFFERENCE = 0.02  # of central differences; the extrapolation's error is of sixth order
TRUSTED = 1e-9  # takes the place of ROUNDING for functions, whose terms are unknown

X, Y, Z = sp.symbols("x y z")
STATE = (X, Y, Z)
AT = np.array([0.3, -0.2, 0.5])


def test_differences_are_of_the_sixth_order():
    """An error of the seventh derivative, by the step to the sixth."""
    direction = np.array([0.6, 0.0, 0.8])

    def off(step):
        found = central_difference(lambda x: np.sin(3 * x), AT, direction, step)
        return np.abs(found - 3 * np.cos(3 * AT) * direction).max()

    assert 2**5.7 < off(0.4) / off(0.2) < 2**6.3
    assert off(DIFFERENCE) < 1e-11


@pytest.mark.parametrize("size", [0.0, 0.5, 40.0])
def test_a_derivative_along_a_direction_grows_with_its_length(size):
    direction = size * np.array([0.6, 0.0, 0.8])
    found = central_difference(np.sin, AT, direction)
    assert found == pytest.approx(np.cos(AT) * direction, rel=1e-9)


def numeric(calls=1, **changes):
    return NumericField(lambda x: np.array([x[1] * x[2], 1.0, x[0] ** 2]), **changes,
                        calls=calls)  # fmt: skip


FORMULAS = sp.ImmutableMatrix([Y * Z, 1, X**2])
OTHER = sp.ImmutableMatrix([sp.sin(X), Z, Y])


def test_a_bracket_of_functions_is_that_of_formulas():
    exact = lie_bracket(FORMULAS, OTHER, STATE)
    values = [float(e.subs(dict(zip(STATE, AT, strict=True)))) for e in exact]
    for f, g, sign in ((numeric(), OTHER, 1), (OTHER, numeric(), -1)):
        found = lie_bracket(f, g, STATE)
        assert found(AT) == pytest.approx(sign * np.array(values), abs=1e-9)
    assert lie_bracket(numeric(3), numeric(2), STATE).calls == 35  # two for each of
    # three steps and one in place, of both fields


def test_the_terms_of_a_bracket_are_those_of_its_differences():
    f, g = numeric(), as_numeric(OTHER, STATE)
    found = lie_bracket(f, g, STATE)
    sizes = np.linalg.norm(f(AT)), np.linalg.norm(g(AT))
    assert found.weight(AT) == pytest.approx(2 * sizes[0] * sizes[1] / DIFFERENCE)
    weighed = numeric(terms=lambda x: 7.0)
    assert weighed.weight(AT) == 7.0
    assert f.weight(AT) == pytest.approx(sizes[0])


def test_a_given_derivative_is_used_and_errors_of_functions_say_where():
    slope = numeric(jacobian=lambda x: 2 * np.eye(3))
    assert slope.derivative(AT, np.array([1.0, 2, 3])).tolist() == [2, 4, 6]
    broken = NumericField(lambda x: 1 / 0)
    with pytest.raises(FieldError, match="0.3"):
        broken(AT)
    with pytest.raises(ValueError, match=r"returned shape \(2,\) for a .*\(3,\)"):
        NumericField(lambda x: x[:2])(AT)
    with pytest.raises(KeyboardInterrupt):
        NumericField(lambda x: (_ for _ in ()).throw(KeyboardInterrupt()))(AT)


def test_samples_are_the_same_every_time_and_the_second_half_is_positive():
    points = sample_configurations(3)
    assert points.shape == (12, 3)
    assert points.tolist() == sample_configurations(3).tolist()
    assert points[:6].min() < 0 < points[6:].min()
    assert np.abs(points).max() <= 1.1
    assert points[6:].min() >= 0.1
    assert sample_configurations(2, 5)[2:].min() >= 0.1


@pytest.mark.parametrize(("share", "leaves"), [(0.5, False), (2.0, True)])
def test_rates_of_a_function_s_field_below_its_rounding_are_none(share, leaves):
    level_set = LevelSet((X - Y,), STATE)

    def velocity(x):
        return np.array([1.0, 1.0 + 2 * share * TRUSTED, 0.0])

    assert level_set.leaves(NumericField(velocity)) == leaves
    moved = np.array([0.4, 0.1, 9.0])
    rates = level_set.rates(NumericField(lambda x: moved))
    assert rates.shape == (len(level_set.points), 1)
    assert rates == pytest.approx(np.full(rates.shape, 0.3))


def test_rates_along_formulas_are_zero_where_they_are_singular():
    curved = LevelSet((Z,), STATE)
    field = sp.ImmutableMatrix([0, 0, sp.log(X)])
    rates = curved.rates(field)[:, 0]
    x = curved.points[:, 0]
    assert rates[x > 0] == pytest.approx(np.log(x[x > 0]))
    assert not rates[x < 0].any()
    assert curved.rates(sp.ImmutableMatrix([1, 2, 0])).tolist() == [[0.0]]


def test_points_on_a_set_are_zeros_of_its_functions_where_it_is_regular():
    circle = LevelSet((X**2 + Y**2 - 1, Z - X), STATE)
    assert np.abs(circle.value(circle.points)).max() < 1e-11
    with pytest.raises(ValueError, match="found no configuration where x.*2 .* vanish"):
        _ = LevelSet((X**2 + 1, Z), STATE).points
    with pytest.raises(ValueError, match="are not independent where they vanish"):
        _ = LevelSet((X**2, Z), STATE).points
    with pytest.raises(ValueError, match="not independent .*, at "):
        LevelSet((X * Y,), STATE).require_regular(np.zeros(3))
    LevelSet((X * Y,), STATE).require_regular(np.array([0.0, 1.0, 0.0]))
    LevelSet((), STATE).require_regular(np.zeros(3))
    assert LevelSet((), STATE).gradients(np.zeros((4, 3))).shape == (4, 3, 0)


@pytest.mark.parametrize(("share", "found"), [(0.99, 1), (1.01, 2)])
def test_columns_span_what_differs_by_more_than_a_share_of_their_size(share, found):
    """The lesser singular value of two columns at an angle a is about a / sqrt(2)."""
    angle = share * SPANNED * np.sqrt(2)
    columns = 5.0 * np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]])
    assert rank(columns) == found
    assert nearly_dependent(columns) == (found == 1)
    assert not nearly_dependent(columns[:, :1])
    assert not nearly_dependent(columns[:, [0, 0]])


@pytest.mark.parametrize(
    ("direction", "words"),
    [
        ([1, 0, 0], "x"), ([-1, 0, 0], "-x"), ([0, 0.5, 0], "0.5 y"),
        ([1, -0.25, 0], "x - 0.25 y"), ([-2, 1, 1e-9], "-2 x + y"),
        ([1 + 0.9e-8, 0, 0], "x"), ([1.5, 0, 2e-8], "1.5 x + 2e-08 z"), ([0, 0, 0], ""),
    ],
)  # fmt: skip
def test_a_direction_is_written_as_a_sum(direction, words):
    assert in_words(np.array(direction, dtype=float), STATE) == words


CAR = {"d": sp.ImmutableMatrix([sp.cos(Z), sp.sin(Z), 0]),
       "t": sp.ImmutableMatrix([0, 0, 1])}  # fmt: skip


@pytest.mark.parametrize(
    ("depth", "enough", "rank", "reached", "complete"),
    [
        (1, 9, 2, 1, False),
        (2, 9, 3, 2, False),  # it is not known yet that there are no more
        (3, 9, 3, 2, True),
        (4, 9, 3, 2, True),
        (4, 3, 3, 2, False),
        (4, 2, 2, 1, False),
    ],
)
def test_an_algebra_is_searched_until_it_is_large_or_deep_enough(
    depth, enough, rank, reached, complete
):
    found = involutive_closure(CAR, STATE, np.zeros(3), depth, enough)
    assert (found.rank, found.depth, found.complete) == (rank, reached, complete)
    with pytest.raises(ValueError, match="depth is 0; at least 1 is needed"):
        involutive_closure(CAR, STATE, np.zeros(3), 0, 3)


def test_ranks_are_exact_where_formulas_are_rational():
    near = sp.ImmutableMatrix([1, sp.Float(1e-12), 0])
    fields = [sp.ImmutableMatrix([1, 0, 0]), near, sp.ImmutableMatrix([X + 0.1, Y, 0])]
    assert exact_rank(fields[:2], STATE, AT) == 2
    assert exact_rank([fields[0], fields[2]], STATE, np.array([0.2, 0.0, 0])) == 1
    assert exact_rank([], STATE, AT) == 0
    assert exact_rank([CAR["d"]], STATE, AT) is None  # the cosine is irrational
    assert exact_rank([numeric()], STATE, AT) is None


def test_a_search_ends_where_formulas_grow_too_long(monkeypatch):
    """The degree that was cut short does not count."""
    whole = involutive_closure(CAR, STATE, np.zeros(3), 4, 9)
    monkeypatch.setattr(closure, "MOST_OPERATIONS", 5)
    short = involutive_closure(CAR, STATE, np.zeros(3), 4, 9)
    assert (whole.depth, whole.complete) == (2, True)
    assert (short.depth, short.complete) == (1, False)
    calls = {"f": numeric(calls=4)}
    assert involutive_closure(calls, STATE, np.zeros(3), 1, 9).complete is False
    monkeypatch.setattr(closure, "MOST_OPERATIONS", 39)  # ten for each call
    assert involutive_closure(calls, STATE, AT, 3, 9).depth == 1
    assert not involutive_closure(calls, STATE, AT, 3, 9).complete
    monkeypatch.setattr(closure, "MOST_OPERATIONS", 40)
    assert involutive_closure(calls, STATE, AT, 3, 9).complete
