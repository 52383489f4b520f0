"""Vector fields: brackets by theorems and differences, evaluation, zero fields."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import BudgetError, SingularConfigurationError
from planner.support import limited
from planner.systems.fields import (
    NumericField,
    as_numeric,
    bracket,
    central_difference,
    compile_fields,
    lie_bracket,
)
from planner.systems.rounding import vanishing

STATE = sp.symbols("x y z")
X, Y, Z = STATE
F = sp.Matrix([sp.cos(Y), X * Z, 1])
G = sp.Matrix([Y**2, sp.exp(Z) / 3, sp.sin(X)])
H = sp.Matrix([Z, X * Y, Y])
POINTS = np.random.default_rng(1).uniform(-1, 1, (5, 3))
# extrapolated differences err by STEP^6 and by rounding over STEP, both near 1e-12
DIFFERENCES = 1e-10


def evaluate(field, x):
    return compile_fields([field], STATE)(x)[..., 0]


def bracket_by_differences(f, g, x):
    """[f, g] from values alone."""

    def along(a, b):
        return central_difference(lambda z: evaluate(b, z), x, evaluate(a, x))

    return along(f, g) - along(g, f)


@pytest.mark.parametrize("x", POINTS)
def test_bracket_agrees_with_finite_differences(x):
    assert evaluate(bracket(F, G, STATE), x) == pytest.approx(
        bracket_by_differences(F, G, x), abs=DIFFERENCES
    )


def test_finite_differences_tell_a_wrong_sign_from_a_right_one():
    wrong = -bracket(F, G, STATE)
    x = POINTS[0]
    assert np.abs(evaluate(wrong, x) - bracket_by_differences(F, G, x)).max() > 0.1


def test_bracket_of_the_heisenberg_fields_is_the_third_direction():
    first, second = sp.Matrix([1, 0, -Y / 2]), sp.Matrix([0, 1, X / 2])
    assert bracket(first, second, STATE) == sp.Matrix([0, 0, 1])


def test_bracket_is_antisymmetric():
    assert sp.expand(bracket(F, G, STATE) + bracket(G, F, STATE)) == sp.zeros(3, 1)


def test_bracket_runs_no_texts():
    with pytest.raises(ValueError, match="SympifyError: 'print"):
        bracket(["print(1)", 0, 0], [0, 1, 0], STATE)


def test_brackets_satisfy_the_jacobi_identity():
    def twice(a, b, c):
        return bracket(a, bracket(b, c, STATE), STATE)

    cycle = twice(F, G, H) + twice(G, H, F) + twice(H, F, G)
    assert sp.expand(cycle) == sp.zeros(3, 1)


def test_bracket_is_what_the_commutator_of_flows_leaves():
    # Sec. 2: back along both flows ends epsilon^2 [f, g] away, up to epsilon^3
    from planner.numerics.collocation import follow

    x, epsilon = POINTS[0], 1e-3
    for field, sign in ((F, 1), (G, 1), (F, -1), (G, -1)):
        x = follow(lambda z, f=field: evaluate(f, z), x, sign * epsilon)
    expected = evaluate(bracket(F, G, STATE), POINTS[0])
    assert (x - POINTS[0]) / epsilon**2 == pytest.approx(expected, abs=10 * epsilon)


def test_numeric_fields_have_the_brackets_of_their_symbolic_twins():
    f = NumericField(lambda x: [np.cos(x[1]), x[0] * x[2], 1.0])
    g = NumericField(lambda x: [x[1] ** 2, np.exp(x[2]) / 3, np.sin(x[0])])
    exact = evaluate(bracket(F, G, STATE), POINTS)
    both = evaluate(lie_bracket(f, g, STATE), POINTS)
    mixed = evaluate(lie_bracket(f, sp.ImmutableMatrix(G), STATE), POINTS)
    assert both == pytest.approx(exact, abs=DIFFERENCES)
    assert mixed == pytest.approx(exact, abs=DIFFERENCES)


def test_numeric_brackets_can_be_bracketed_again():
    f, g = (as_numeric(sp.ImmutableMatrix(field), STATE) for field in (F, G))
    plain = NumericField(f.value), NumericField(g.value)
    inner = lie_bracket(*plain, STATE)
    exact = evaluate(bracket(F, bracket(F, G, STATE), STATE), POINTS)
    # each differentiation divides rounding by the step
    assert evaluate(lie_bracket(plain[0], inner, STATE), POINTS) == pytest.approx(
        exact, abs=1e-8
    )


def test_given_jacobian_is_used():
    exact = NumericField(
        lambda x: [x[0] ** 2, 0, 0], lambda x: np.diag([2 * x[0], 0, 0])
    )
    x = np.array([3.0, 0, 0])
    assert exact.derivative(x, np.array([1.0, 1, 1])).tolist() == [6.0, 0, 0]


def test_compiled_fields_take_many_configurations_at_once():
    compiled = compile_fields([F, G], STATE)
    together = compiled(POINTS.reshape(1, 5, 3))
    one_by_one = [
        [[e.subs(dict(zip(STATE, x, strict=True))) for e in f] for f in (F, G)]
        for x in POINTS
    ]
    expected = np.array(one_by_one, dtype=float).swapaxes(1, 2)
    assert together.shape == (1, 5, 3, 2)
    assert together[0] == pytest.approx(expected, abs=1e-14)


def test_singular_configuration_is_named():
    compiled = compile_fields([sp.Matrix([1 / X, 0, 0])], STATE, ["drift"])
    with pytest.raises(
        SingularConfigurationError, match=r"drift is not finite at \(0, 2, 3\)"
    ):
        compiled(np.array([[1.0, 2, 3], [0, 2, 3]]))


def test_fields_that_cancel_vanish_and_others_do_not():
    identity = sp.ImmutableMatrix([sp.sin(X) ** 2 + sp.cos(X) ** 2 - 1, 0, 0])
    small = sp.ImmutableMatrix([1e-6 * X, 0, 0])
    singular = sp.ImmutableMatrix([sp.log(-(X**2) - 1), 0, 0])
    assert vanishing([identity, small, singular], STATE) == (True, False, False)


def test_field_of_wrong_shape_is_refused():
    with pytest.raises(
        ValueError, match=r"shape \(2, 1\); the state asks for \(3, 1\)"
    ):
        bracket(sp.Matrix([1, 2]), G, STATE)


def test_numeric_field_of_wrong_shape_is_refused():
    field = NumericField(lambda x: [1.0, 2.0])
    with pytest.raises(ValueError, match=r"returned shape \(2,\) for .* shape \(3,\)"):
        field(np.zeros(3))


def test_symbols_that_are_only_called_as_those_of_the_state_are_refused():
    """They would count as constants, and brackets as zero; parameters may be there."""
    real = sp.Symbol("x", real=True)
    with pytest.raises(ValueError, match="the symbol x of a field is not that of the"):
        bracket([1, 0, 0], [0, 1, real], STATE)
    length = sp.Symbol("l")
    assert list(bracket([1, 0, 0], [0, 1, length * X], STATE)) == [0, 0, length]


def test_a_bracket_of_nested_functions_ends_in_time():
    """Its slopes may take minutes, in which nothing else looks at the clock."""
    x, y = sp.symbols("x y")
    with pytest.raises(BudgetError), limited(0.0):
        bracket(
            sp.Matrix([sp.sin(sp.cos(x * y)), 0]), sp.Matrix([0, sp.sin(x)]), (x, y)
        )
