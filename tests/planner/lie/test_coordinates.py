"""Hall coordinates against their flows in the truncated tensor algebra."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from planner.errors import ConvergenceError
from planner.lie import coordinates
from planner.lie.coordinates import (
    adjoint_action,
    backward,
    backward_from_forward,
    backward_matrix,
    exponential,
    forward,
    integrate,
    logarithm,
)
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import hall_basis
from planner.lie.tensor import Tensor
from planner.numerics.collocation import collocation
from tests.planner.lie.test_free_lie import equal, numbers
from tests.systems import hall_elements

BASES = [hall_basis(2, 5), hall_basis(3, 3), hall_basis(4, 2), hall_basis(1, 1)]
PAPER = hall_elements(["1", "2", "3", "4", "[1,2]"])  # the elements of Sec. 6
ROUNDING = 1e-11  # measured: below 1e-12 for coordinates up to 1

some = settings(max_examples=25, deadline=None)


def vectors(basis):
    entries = st.lists(st.floats(-1, 1), min_size=len(basis), max_size=len(basis))
    return entries.map(np.array)


def basis_and(count):
    """A basis and some vectors over it."""
    return st.sampled_from(BASES).flatmap(
        lambda basis: st.tuples(st.just(basis), *[vectors(basis)] * count)
    )


def flow(basis, coordinates, order):
    """The product of the exponentials of h_j B_j, the first or the last at its left."""
    algebra = lie_algebra(basis)
    factors = [algebra.expand(h).exp() for h in np.diag(coordinates)]
    total = algebra.expand(np.zeros(len(basis))).unit
    for factor in factors if order == "forward" else reversed(factors):
        total = total * factor
    return total


def entries(tensor):
    return np.concatenate(tensor.levels)


def close(a, b):
    return entries(a) == pytest.approx(entries(b), abs=ROUNDING)


def wave(basis):
    """Smooth inputs v(t), each with a frequency and phase of its own."""
    k = np.arange(1, len(basis) + 1)
    return lambda t: np.cos(k * t + k**2)


def solution(basis, v):
    """S(1) by eq. (7), integrated word by word."""
    algebra = lie_algebra(basis)
    one = algebra.expand(np.zeros(len(basis))).unit
    cuts = np.cumsum([level.size for level in one.levels])[:-1]

    def rates(t, values):
        return entries(Tensor(tuple(np.split(values, cuts))) * algebra.expand(v(t)))

    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-12}
    end = solve_ivp(rates, (0, 1), entries(one), **options).y[:, -1]
    return Tensor(tuple(np.split(end, cuts)))


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_coordinates_rebuild_the_solution_of_eq_7(basis):
    h = backward(basis, wave(basis))
    expected = entries(solution(basis, wave(basis)))
    # ten times what the integrator promises, summed over its steps
    assert entries(flow(basis, h, "backward")) == pytest.approx(expected, abs=1e-10)


def test_two_generators_have_the_rates_printed_by_lafferriere_and_sussmann():
    h1, h2 = sp.symbols("h1 h2")
    v1, v2, v3, v4, v5 = v = sp.symbols("v1:6")
    assert list((backward_matrix(hall_basis(2, 3)) * sp.Matrix(v)).expand()) == [
        v1,
        v2,
        v3 + h1 * v2,
        sp.expand(v4 + h1 * v3 + h1**2 * v2 / 2),
        sp.expand(v5 + h2 * v3 + h1 * h2 * v2),
    ]


@pytest.mark.parametrize("basis", [*BASES, PAPER], ids=len)
def test_matrix_inverts_the_adjoint_maps_of_eq_8(basis):
    algebra = lie_algebra(basis)
    h = np.random.default_rng(1).uniform(-1, 1, len(basis))
    columns, unit = np.eye(len(basis)), np.eye(len(basis))
    for j in range(len(basis) - 1, -1, -1):
        columns[j + 1 :] @= expm(-h[j] * algebra.bracket(unit[j], unit))
    symbols = sp.symbols(f"h1:{len(basis) + 1}")
    A = np.array(backward_matrix(basis).subs(dict(zip(symbols, h, strict=True))), float)
    assert pytest.approx(np.eye(len(basis)), abs=ROUNDING) == A @ columns.T


def test_fifth_hall_coordinate_is_5_8_where_the_paper_prints_3_4():
    v = np.array([1, 1, -1, -1, 1]) / 2
    expected = [1 / 2, 1 / 2, -1 / 2, -1 / 2, 5 / 8]
    assert backward(PAPER, v) == pytest.approx(expected, abs=1e-15)
    assert backward(PAPER, lambda t: v) == pytest.approx(expected, abs=1e-12)


def test_brackets_that_are_not_driven_grow_with_the_first_generator():
    basis = hall_basis(3, 2)
    h = backward(basis, [0.3, 0.5, 0.7, 0.0, 0.0, 0.0])
    expected = [h[0] * h[1] / 2, h[0] * h[2] / 2, h[1] * h[2] / 2]
    assert h[3:] == pytest.approx(expected, abs=1e-15)


def test_elements_that_vanish_leave_the_other_coordinates_as_they_are():
    full = hall_basis(4, 2)
    kept = [full.index(e) for e in PAPER]
    v = wave(full)
    expected = backward(full, v)[kept]
    assert backward(PAPER, lambda t: v(t)[kept]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_segments_integrate_as_if_each_were_alone(basis):
    rng = np.random.default_rng(2)
    slope, value = rng.uniform(-1, 1, (2, 3, len(basis)))
    nodes = collocation(2 * basis_degree(basis)).nodes[:, None]
    inputs = slope[:, None] * nodes + value[:, None]
    alone = [backward(basis, lambda t, k=k: slope[k] * t + value[k]) for k in range(3)]
    assert integrate(basis, inputs) == pytest.approx(np.array(alone), abs=1e-11)


def basis_degree(basis):
    return max(2, lie_algebra(basis).max_degree)


@some
@given(basis_and(2))
def test_integration_from_a_start_appends_a_flow(case):
    basis, start, v = case
    inputs = np.broadcast_to(v, (basis_degree(basis), len(basis)))
    end = integrate(basis, inputs, start)
    expected = flow(basis, start, "backward") * lie_algebra(basis).expand(v).exp()
    assert close(flow(basis, end, "backward"), expected)


@some
@given(basis_and(1))
def test_forward_and_backward_coordinates_are_of_the_same_flow(case):
    basis, h = case
    f = forward(basis, h)
    assert close(flow(basis, f, "forward"), flow(basis, h, "backward"))
    assert backward_from_forward(basis, f) == pytest.approx(h, abs=ROUNDING)


@some
@given(basis_and(1))
def test_logarithm_is_the_exponent_of_the_flow(case):
    basis, h = case
    a = logarithm(basis, h)
    exponent = lie_algebra(basis).expand(a).exp()
    assert close(exponent, flow(basis, h, "backward"))
    assert exponential(basis, a) == pytest.approx(h, abs=ROUNDING)


@some
@given(basis_and(2))
def test_an_exponential_that_begins_at_a_flow_runs_one_flow_after_the_other(case):
    basis, g, h = case
    expected = flow(basis, g, "backward") * flow(basis, h, "backward")
    product = exponential(basis, logarithm(basis, h), np.asarray(g))
    assert close(flow(basis, product, "backward"), expected)


def test_coordinates_of_many_flows_are_transformed_at_once():
    basis = hall_basis(2, 4)
    h = np.random.default_rng(4).uniform(-1, 1, (5, 3, len(basis)))
    one_by_one = [[forward(basis, each) for each in row] for row in h]
    assert forward(basis, h) == pytest.approx(np.array(one_by_one), abs=ROUNDING)


def test_inputs_of_another_shape_are_refused():
    basis = hall_basis(2, 2)
    with pytest.raises(
        ValueError, match=r"inputs of shape \(2,\) do not fit .*; give 3"
    ):
        backward(basis, [1.0, 2.0])
    with pytest.raises(ValueError, match=r"inputs at 0 of shape \(4,\) do not fit the"):
        backward(basis, lambda t: [t, t, t, t])


@pytest.mark.parametrize("begin", [0.0, 0.1237, 0.4101, 0.75])
def test_pulses_of_a_three_hundredth_of_the_time_are_seen(begin):
    h = backward(
        hall_basis(2, 2), lambda t: [300.0 * (begin < t < begin + 1 / 300)] * 3
    )
    # both ends are found to the last digits of the time, which the height multiplies
    assert h[:2] == pytest.approx([1, 1], abs=1e-11)


def test_noise_is_refused_after_a_bounded_number_of_evaluations(monkeypatch):
    monkeypatch.setattr(coordinates, "EVALUATIONS", 5_000)
    noise, calls = np.random.default_rng(4), []

    def inputs(t):
        calls.append(t)
        return noise.normal(size=3)

    with pytest.raises(ConvergenceError, match="inputs still change from one time"):
        backward(hall_basis(2, 2), inputs)
    assert len(calls) == 5_000


def test_inputs_that_grow_beyond_all_bounds_are_refused():
    with pytest.raises(ConvergenceError, match="inputs at 0.7 move .*; keep them"):
        backward(hall_basis(2, 2), lambda t: [1.0, 1 / (0.7 - t), 0.0])


def test_coordinates_that_are_not_finite_are_refused():
    basis = hall_basis(2, 2)
    with pytest.raises(
        ValueError, match=r"coordinates are not finite: \[1.0, nan, 0.0"
    ):
        forward(basis, [1.0, np.nan, 0.0])
    with pytest.raises(ValueError, match="inputs at .* are not finite"):
        backward(basis, lambda t: [t, t, np.inf if t > 0.5 else t])


@settings(max_examples=25, deadline=None)  # exact numbers are slow
@given(st.data())
def test_adjoint_action_is_conjugation(data):
    basis = hall_basis(2, 4)
    algebra = lie_algebra(basis)
    b, h = data.draw(numbers(basis)), data.draw(numbers(basis))
    j = data.draw(st.integers(0, len(basis) - 1))
    a = h * np.eye(len(basis), dtype=int)[j]
    moved = adjoint_action(algebra.structure[j], h[j], dict(enumerate(b)))
    conjugate = algebra.expand(a).exp() * algebra.expand(b) * algebra.expand(-a).exp()
    vector = np.array([moved[k] for k in range(len(basis))], dtype=object)
    assert equal(algebra.expand(vector), conjugate)


def test_inputs_may_fill_the_same_array_at_every_call():
    basis, buffer = hall_basis(2, 2), np.zeros(3)

    def inputs(time):
        buffer[:2] = 1, 2 * time
        return buffer

    fresh = backward(basis, lambda time: [1, 2 * time, 0])
    assert backward(basis, inputs) == pytest.approx(fresh, abs=1e-12)


def test_what_floats_cannot_hold_and_inputs_without_nodes_are_refused():
    basis = hall_basis(2, 3)
    with pytest.raises(ValueError, match="coordinates are not finite: .* inf"):
        backward(basis, [1e200] * 5)
    with pytest.raises(ValueError, match=r"shape \(5,\) have no axis of nodes before"):
        integrate(basis, [1.0] * 5)
