"""The least-dissipation twist: a minimum by certificate, and cases in closed form."""

import numpy as np
import pytest
from scipy.optimize import minimize

from models.contact import dissipation as dissipation_module
from models.contact.dissipation import (
    foot_jacobians,
    foot_velocities,
    least_dissipation_twist,
)
from models.contact.kinematics import Kinematics
from models.contact.loads import static_loads
from models.library import load

SQUARE = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])


@pytest.fixture(params=[3, 4, 6], ids="{} feet".format)
def many(request):
    rng = np.random.default_rng(request.param)
    n, feet = 40, request.param
    return (
        rng.normal(size=(n, feet, 2)),
        rng.normal(size=(n, feet, 2)),
        rng.uniform(0.1, 1.0, size=(n, feet)),
    )


def dissipation(feet, rates, loads, twist):
    speed = np.linalg.norm(foot_velocities(feet, rates, twist), axis=-1)
    return (loads * speed).sum(axis=-1)


def certificate(feet, rates, loads, twist):
    """Lower bound on the dissipation of any twist, by duality.

    Friction forces s within their cones and without resultant, sum J^T s = 0, bound it
    by sum s . v from below; sliding feet have theirs, sticking ones balance the rest.
    """
    w = foot_velocities(feet, rates, twist)
    speed = np.linalg.norm(w, axis=-1)
    sticks = speed < 1e-7 * np.abs(rates).max()
    s = np.where(
        sticks[:, None], 0.0, loads[:, None] * w / np.maximum(speed, 1e-300)[:, None]
    )
    J = foot_jacobians(feet)
    rest = np.einsum("fij,fi->j", J, s)
    held = J[sticks].reshape(-1, 3)
    s[sticks] -= (np.linalg.pinv(held).T @ rest).reshape(-1, 2) if len(held) else 0.0
    unbalanced = np.abs(np.einsum("fij,fi->j", J, s)).max()
    outside = np.maximum(np.linalg.norm(s, axis=-1) - loads, 0.0).max()
    return (s * rates).sum(), unbalanced, outside


def test_no_twist_dissipates_less(many):
    twists = least_dissipation_twist(*many)
    for feet, rates, loads, twist in zip(*many, twists, strict=True):
        bound, unbalanced, outside = certificate(feet, rates, loads, twist)
        # Newton ends at a smoothing of 1e-7 and steps below 1e-10
        assert unbalanced < 1e-6
        assert outside < 1e-6
        assert dissipation(feet, rates, loads, twist) == pytest.approx(bound, rel=1e-6)


def test_an_independent_optimiser_finds_nothing_better(many):
    twists = least_dissipation_twist(*many)
    for feet, rates, loads, twist in zip(
        *(part[:5] for part in many), twists, strict=False
    ):

        def power(x, case=(feet, rates, loads)):
            return dissipation(*case, x)

        found = minimize(
            power, np.zeros(3), method="Nelder-Mead", options={"maxiter": 4000}
        )
        assert power(twist) <= found.fun * (1 + 1e-12)


def test_twist_scales_with_the_rates(many):
    feet, rates, loads = many
    whole = least_dissipation_twist(feet, rates, loads)
    assert least_dissipation_twist(feet, -3 * rates, 7 * loads) == pytest.approx(
        -3 * whole, abs=1e-6
    )


def test_feet_that_can_follow_the_body_do_not_slip():
    twist = np.array([[0.3, -0.2, 0.7]])
    rates = -foot_velocities(SQUARE[None], np.zeros((1, 4, 2)), twist)
    loads = np.array([[0.1, 0.2, 0.3, 0.4]])
    assert least_dissipation_twist(SQUARE[None], rates, loads) == pytest.approx(twist)


def test_a_foot_that_carries_most_of_the_weight_sticks():
    rates = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.5]]])
    loads = np.array([[0.7, 0.1, 0.1, 0.1]])
    twist = least_dissipation_twist(SQUARE[None], rates, loads)
    held = foot_velocities(SQUARE[None], rates, twist)[0, 0]
    assert held == pytest.approx([0.0, 0.0], abs=1e-15)


def test_one_dragging_foot_does_not_move_a_body_that_three_others_hold():
    rates = np.zeros((1, 4, 2))
    rates[0, 0] = (-1.0, 0.5)
    twist = least_dissipation_twist(SQUARE[None], rates, np.full((1, 4), 0.25))
    assert twist == pytest.approx(np.zeros((1, 3)), abs=1e-12)


def test_loads_may_be_in_any_unit(many):
    feet, rates, loads = many
    twist = least_dissipation_twist(feet, rates, loads)
    for unit in (1e-200, 1e200):
        assert least_dissipation_twist(feet, rates, unit * loads) == pytest.approx(
            twist, abs=1e-6
        )


def test_every_foot_that_bears_most_of_the_weight_is_exactly_at_rest():
    rng = np.random.default_rng(5)
    feet, rates = rng.normal(size=(2, 200, 4, 2))
    loads = np.tile([0.7, 0.1, 0.1, 0.1], (200, 1))
    twist = least_dissipation_twist(feet, rates, loads)
    held = foot_velocities(feet, rates, twist)[:, 0]
    assert np.abs(held).max() < 1e-14  # rounding


def test_feet_that_touch_at_one_point_slide_about_their_median_and_do_not_turn():
    feet = np.array([[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]])
    corners = np.array([[1.0, 0.0], [-0.5, np.sqrt(0.75)], [-0.5, -np.sqrt(0.75)]])
    rates = np.vstack([corners + (2.0, 1.0), [[0.0, 0.0]]])[None]
    loads = np.array([[1.0, 1.0, 1.0, 0.0]])
    twist = least_dissipation_twist(feet, rates, loads)
    assert twist == pytest.approx(np.array([[-2.0, -1.0, 0.0]]), abs=1e-6)


def test_a_minimum_that_friction_certifies_is_not_searched_any_further(monkeypatch):
    def search(problem, start):
        pytest.fail("Newton's method is used")

    monkeypatch.setattr(dissipation_module._Problem, "improve", search)
    test_a_foot_that_carries_most_of_the_weight_sticks()
    test_feet_that_can_follow_the_body_do_not_slip()


def test_rows_are_independent_of_each_other(many):
    together = least_dissipation_twist(*many)
    alone = [
        least_dissipation_twist(*(part[i : i + 1] for part in many))[0]
        for i in range(5)
    ]
    # lengths are scaled by the farthest foot of all rows: rounding differs
    assert together[:5] == pytest.approx(np.array(alone), abs=1e-6)


def test_nothing_moves_where_no_foot_does():
    twist = least_dissipation_twist(SQUARE[None], np.zeros((1, 4, 2)), np.ones((1, 4)))
    assert (twist == 0).all()


def test_where_two_twists_all_but_tie_one_of_them_is_found():
    """Tripods of parallel legs drag one foot straight beside the turn of the others."""
    robot = load("hexapod-parallel")
    on, swing = robot.planted("1"), np.array([1.0, 0.0])[robot.group_of_leg, None]
    angles = np.linspace(-0.0286, -0.0268, 400)  # Newton's steps lead astray at some
    stance = Kinematics(robot).stance(np.stack([angles, 0 * angles - 0.4], axis=1))
    feet, rates = stance.feet[:, on], (stance.rates * swing)[:, on]
    loads = static_loads(feet, stance.center_of_mass)
    for case in zip(feet, rates, loads, strict=True):
        (twist,) = least_dissipation_twist(*(part[None] for part in case))
        _, unbalanced, outside = certificate(*case, twist)
        assert max(unbalanced, outside) < 1e-6
