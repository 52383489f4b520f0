"""How long formulas, and how large numbers in them, are read; how far algebras go."""

from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from planner.systems.closure import _Span, exact_rank
from planner.systems.elements import parse_names
from planner.systems.fields import KINKS, NumericField, lie_bracket
from planner.systems.formulas import _power, read_formula

X = sp.Symbol("x")


def test_a_formula_has_ten_thousand_characters_at_most():
    assert read_formula("x" + " " * 9_999, [X]) == X
    with pytest.raises(ValueError, match="10001 characters long, 10000 at most"):
        read_formula("x" + " " * 10_000, [X])


def test_a_term_has_64_factors_at_most():
    assert read_formula("*".join(["x"] * 64), [X]) == X**64
    with pytest.raises(ValueError, match="a term of 65 factors"):
        read_formula("*".join(["x"] * 65), [X])


def test_powers_are_multiplied_out_up_to_1024_bits():
    assert _power(sp.Integer(8), sp.Integer(256)) == 2**768  # of a number of four bits
    with pytest.raises(ValueError, match="'17' to the power 205 is too large"):
        _power(sp.Integer(17), sp.Integer(205))  # five bits make 1025


def test_fractions_of_a_formula_have_1024_bits_at_most():
    small = "2**-341 * 2**-341 * 2**-341"  # together a number of 1024 bits
    assert read_formula(f"x + {small}", [X]).subs(X, 0) == sp.Rational(1, 2**1023)
    with pytest.raises(ValueError, match="in 1024 bits"):
        read_formula(f"x + {small} / 2", [X])


@pytest.mark.parametrize(
    "text",
    ["Abs(log(x + 2))", "Abs(x/(x + 3))", "x*sign(sqrt(x + 1) - 2)", "x*log(2**70)"],
)
def test_slopes_and_values_are_those_of_real_numbers(text):
    """Sympy's own slope of an absolute value is that of a complex one."""
    found, step = read_formula(text, [X]), 1e-6
    slope, value = (
        sp.lambdify(X, e, modules=[KINKS, np]) for e in (found.diff(X), found)
    )
    differences = (value(0.3 + step) - value(0.3 - step)) / (2 * step)
    assert slope(0.3) == pytest.approx(differences, rel=1e-8)  # 1e-16 by the step


def test_constants_are_what_they_are_exactly_however_they_round():
    assert read_formula("acos(sqrt(2)*sqrt(2)/2)*x", [X]) == 0
    assert read_formula("0*sqrt(x - 9)", [X]) == 0  # whatever a name stands for
    with pytest.raises(ValueError, match=r"'acos\(2\)' has nan, no real number"):
        read_formula("acos(2)*x", [X])


def test_an_element_has_twenty_brackets_at_most():
    def nested(count):
        return "[f," * count + "g" + "]" * count

    parse_names(nested(20))
    with pytest.raises(ValueError, match="more than 20 brackets; use fewer"):
        parse_names(nested(21))


def test_exact_ranks_are_those_of_matrices_of_400_entries_at_most():
    column = sp.Matrix([1])
    assert exact_rank([column] * 400, (X,), np.zeros(1)) == 1
    assert exact_rank([column] * 401, (X,), np.zeros(1)) is None


@pytest.mark.parametrize(
    ("known", "operations", "full"),
    [(150, 50_000, False), (151, 0, True), (0, 50_001, True)],
)
def test_an_algebra_has_150_fields_or_50000_operations_at_most(known, operations, full):
    search = SimpleNamespace(
        _sound=np.ones(80, dtype=bool),
        _columns=np.zeros((10, 0)),
        _known=[None] * known,
        _operations=operations,
    )
    assert _Span.full.fget(search) == full


def test_fields_are_compared_in_eighty_places_from_a_thousandth_to_one_away():
    """As many fields are told apart as half the numbers that are compared."""
    at = np.full(200, pi)
    search = _Span(sp.symbols("x:200"), at, [])
    away = np.abs(search._evaluation.points - at).max(axis=1)
    assert len(away) == 80
    assert away[0] == 0
    assert away[1:41] == pytest.approx(1.0, rel=0.1)  # of which the largest are random
    assert away[-1] == pytest.approx(1e-3, rel=0.1)


def test_a_bracket_of_functions_takes_seven_calls_of_each():
    """Which are called once for a velocity, and six times more for its derivative."""
    calls = [0]

    def turning(x):
        calls[0] += 1
        return np.array([1.0, x[0]])

    plain = NumericField(turning)
    plain(np.zeros(2))
    assert plain.calls == calls[0] == 1
    assert lie_bracket(plain, plain, sp.symbols("x y")).calls == 14
