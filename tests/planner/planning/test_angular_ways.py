"""Angles whose rates are of the form c + a cos + b sin of them, flow after flow."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from planner.numerics.collocation import collocation
from planner.planning.rollouts import _angular_ways

RULE = collocation(17)
C, A, B = np.array([[0.3, -0.8, 0.0, 0.5], [0.6, 0.2, 0.0, 0.0], [-0.4, 0.7, 0.0, 0.0]])
DURATIONS = np.array([0.9, -0.7, 1.0, 0.5])


def rate(angle, t=0.0):
    """Of each flow, with a part of it that changes along the flow."""
    steady = C + A * np.cos(angle) + B * np.sin(angle)
    return steady * (1 + 0.3 * np.asarray(t))


@pytest.mark.parametrize("start", [0.0, 2.0, -3.1, 40.0])
def test_ways_are_those_of_the_equation_s_integral(start):
    found = _angular_ways(
        lambda angle: rate(angle, RULE.nodes[:, None]), start, DURATIONS, RULE
    )
    at = start
    for k, duration in enumerate(DURATIONS):
        true = solve_ivp(
            lambda t, angle, k=k, T=duration: [T * rate(angle[0], t)[k]],
            (0.0, 1.0),
            [at],
            t_eval=RULE.nodes,
            rtol=1e-11,
            atol=1e-12,
        )
        assert found[:, k] == pytest.approx(true.y[0] - at, abs=1e-8)  # of the solver
        at = true.y[0, -1]


def test_flows_that_turn_too_far_are_left_to_others():
    rates = np.ones((len(RULE.nodes), 1))
    assert _angular_ways(lambda _: rates, 0.0, np.array([3.1]), RULE) is not None
    assert _angular_ways(lambda _: rates, 0.0, np.array([np.pi]), RULE) is None
    assert _angular_ways(lambda _: np.nan * rates, 0.0, np.ones(1), RULE) is None
