"""Collocation matrices on polynomials, and flows against closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from planner.errors import ConvergenceError
from planner.numerics.collocation import collocation, follow

ROUNDING = 1e-11  # derivatives of degree 8 amplify 1e-16 by some k^4


@pytest.mark.parametrize("size", [2, 5, 9])
def test_matrices_differentiate_and_integrate_polynomials_exactly(size):
    rule = collocation(size)
    power = np.arange(size)
    values = rule.nodes[:, None] ** power
    derivative = power * rule.nodes[:, None] ** np.maximum(power - 1, 0)
    assert rule.derivative @ values == pytest.approx(derivative, abs=ROUNDING)
    integral = rule.nodes[:, None] ** (power + 1) / (power + 1)
    assert rule.integral @ values == pytest.approx(integral, abs=ROUNDING)


def test_nodes_include_both_ends():
    assert collocation(7).nodes[[0, -1]].tolist() == [0.0, 1.0]


def test_one_node_is_refused():
    with pytest.raises(ValueError, match="at least 2 nodes, got 1"):
        collocation(1)


def test_flow_of_a_linear_field_is_the_matrix_exponential():
    matrix = np.array([[0.1, -2.0, 0], [2.0, 0.1, 0.3], [0, 0.5, -0.4]])
    x = np.array([1.0, 0.5, -0.3])
    for duration in (3.0, -1.0, 20.0):
        end = follow(lambda z: z @ matrix.T, x, duration)
        # growth of errors along the flow is at most that of the flow itself
        exact = expm(duration * matrix) @ x
        assert end == pytest.approx(exact, rel=1e-10, abs=1e-10)


def test_flow_of_a_nonlinear_field_agrees_with_another_integrator():
    def pendulum(z):
        return np.stack([z[..., 1], -np.sin(z[..., 0])], axis=-1)

    x = np.array([2.0, 0.1])
    other = solve_ivp(
        lambda _, z: pendulum(z), (0, 7), x, method="DOP853", rtol=1e-13, atol=1e-13
    )
    # the other integrator's own tolerance, accumulated
    assert follow(pendulum, x, 7.0) == pytest.approx(other.y[:, -1], abs=1e-11)


def test_flow_back_returns():
    def field(z):
        return np.stack([np.cos(z[..., 1]), z[..., 0] ** 2], axis=-1)

    x = np.array([0.3, -0.2])
    there = follow(field, x, 0.9)
    assert follow(field, there, -0.9) == pytest.approx(x, abs=1e-12)


def test_flow_decays_over_many_time_constants():
    end = follow(lambda z: -z, np.array([1.0]), 40.0)
    # steps stop where their error falls below the tolerance relative to 1
    assert end == pytest.approx(np.exp(-40), abs=1e-12)


def test_a_flow_far_too_long_for_its_nodes_is_soon_halved():
    tried = []

    def counted(z):
        tried.append(len(z))
        return np.stack([z[..., 1], -np.sin(z[..., 0])], axis=-1)

    follow(counted, np.array([2.0, 0.1]), 20.0)
    halved = tried.index(1, 1)  # a flow begins with the velocity at its start
    assert halved <= 9  # of the 40 iterations that are allowed, and took place


def test_flow_that_ends_in_a_singularity_is_refused():
    with pytest.raises(ConvergenceError, match="it escapes or is not smooth"):
        follow(lambda z: -1 / z, np.array([1.0]), 0.6)


def test_flow_that_escapes_is_refused():
    with pytest.raises(
        ConvergenceError, match=r"flow for 2 from \(1\) does not converge"
    ):
        follow(lambda z: z**2, np.array([1.0]), 2.0)
