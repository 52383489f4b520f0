"""The least-dissipation twist: a minimum by certificate, and cases in closed form."""

import numpy as np
import pytest
from scipy.optimize import minimize

from models.contact import dissipation as dissipation_module
from models.contact.dissipation import (
    ellipses,
    foot_jacobians,
    foot_velocities,
    least_dissipation_twist,
    viscous_twist,
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


def test_friction_that_depends_on_the_direction_is_minimised_too(many):
    """No optimiser finds less; equal axes of every ellipse change nothing."""
    feet, rates, loads = (part[:3] for part in many)
    turned = np.random.default_rng(7).uniform(-np.pi, np.pi, loads.shape)
    along = np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    alike = least_dissipation_twist(feet, rates, loads)
    round_ = least_dissipation_twist(feet, rates, loads, ellipses(along, (2.0, 2.0)))
    assert round_ == pytest.approx(alike, abs=1e-7)
    grip = ellipses(along, (0.4, 2.0))
    for i, twist in enumerate(least_dissipation_twist(feet, rates, loads, grip)):

        def power(xi, i=i):
            v = foot_velocities(feet[i], rates[i], xi)
            dragged = np.linalg.norm((grip[i] @ v[..., None])[..., 0], axis=-1)
            return (loads[i] * dragged).sum()

        for start in (twist, alike[i], np.zeros(3)):
            options = {"xatol": 1e-10, "fatol": 1e-12, "maxiter": 2000}
            least = minimize(power, start, method="Nelder-Mead", options=options)
            assert power(twist) <= least.fun * (1 + 1e-7)


def test_a_skate_goes_where_it_rolls():
    """Two feet that hardly rub along y: pushed along x and y they yield along y."""
    feet = np.array([[[0.0, 1.0], [0.0, -1.0], [1.0, 0.0]]])
    rates = np.array([[[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]])
    along = np.broadcast_to([0.0, 1.0], feet.shape)
    grip = ellipses(along, (1e-3, 1.0))
    grip[:, 2] = np.eye(2)
    twist = least_dissipation_twist(feet, rates, np.ones((1, 3)), grip)[0]
    slid = foot_velocities(feet[0], rates[0], twist)
    assert np.abs(slid[:2, 0]).max() < 1e-3  # what rolling without resistance leaves
    assert slid[:2, 1] == pytest.approx(1.0, abs=3e-3)


# The legs of a quadruped with hips at (+-1, +-1), of length 1 and pointing outwards,
# stand in pairs. Recomputed at points of the grids of C. Prasad and others, in
# harrythespartan9/Geometric-Mechanics-for-quasistatic-legged-systems: angles of both
# legs, the unit direction that keeps the feet's distance, and the body's twist in it.
PAIRS = (
    ("12", 0.628318530717959, -0.942477796076938, 0.76910539983894, 0.639121963273509,
     -0.0143782310566185, -0.0907805781120728, -0.293772121807397),
    ("13", -0.534070751110265, 0.345575191894877, 0.122646110603679, -0.992450468060643,
     0.0445269126908759, -0.510942709726072, 0.217857199976089),
    ("23", -0.534070751110265, 0.345575191894877, 0.728784110160818, 0.684743543800965,
     0.0514880756721184, 0.233340079094535, -0.211719318108742),
    ("24", 0.628318530717959, -0.942477796076938, 0.355410184621091, 0.934710436802543,
     -0.310470915887806, -0.158192832972681, -0.246391113898346),
    ("34", -0.534070751110265, 0.345575191894877, -0.629218698095848,
     -0.777228299772059, -0.484683040563235, 0.0814259086436972, 0.33482389134546),
    ("41", -0.534070751110265, 0.345575191894877, 0.728784110160818, 0.684743543800966,
     -0.0514880756721184, -0.233340079094535, -0.211719318108742),
)  # fmt: skip
HIPS = {"1": (1.0, 1.0), "2": (-1.0, 1.0), "3": (-1.0, -1.0), "4": (1.0, -1.0)}


@pytest.mark.parametrize("given", PAIRS, ids=lambda given: given[0])
def test_the_viscous_law_gives_the_public_grids_of_two_footed_strata(given):
    pair, angles, way, twist = given[0], given[1:3], np.array(given[3:5]), given[5:]
    hips = np.array([HIPS[leg] for leg in pair])
    turned = np.array(angles) + np.where(hips[:, 0] > 0, 0.0, np.pi)
    across = np.stack([-np.sin(turned), np.cos(turned)], axis=-1)
    feet = hips + np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    slope = across @ (feet[0] - feet[1]) * [1.0, -1.0]  # of half the square distance
    keeping = np.array([slope[1], -slope[0]]) / np.hypot(*slope)
    assert keeping == pytest.approx(way, abs=1e-14)
    rates = way[:, None] * across
    found = viscous_twist(feet[None], rates[None], np.ones((1, 2)))[0]
    assert found == pytest.approx(twist, abs=1e-14)
    assert least_dissipation_twist(feet[None], rates[None], np.ones((1, 2)))[
        0
    ] == pytest.approx(found, abs=1e-7)  # feet that keep their distance need not slide


def test_a_foot_that_drags_twice_in_all_directions_is_one_with_four_loads():
    """Drag grows with the square of what the ellipse makes of a velocity."""
    rng = np.random.default_rng(4)
    feet, rates = rng.normal(size=(2, 2, 4, 2))
    loads = rng.uniform(0.5, 1.5, (2, 4))
    grip = np.tile(np.eye(2), (2, 4, 1, 1))
    plain = viscous_twist(feet, rates, loads)
    assert viscous_twist(feet, rates, loads, grip) == pytest.approx(plain)
    grip[:, 1] *= 2
    heavy = loads * [1, 4, 1, 1]
    known = viscous_twist(feet, rates, heavy)
    assert viscous_twist(feet, rates, loads, grip) == pytest.approx(known)
    assert np.abs(known - plain).max() > 0.01
