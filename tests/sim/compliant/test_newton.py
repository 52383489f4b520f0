"""Newton's method on the law of contact: its derivatives, its steps and its errors."""

from dataclasses import replace

import numpy as np
import pytest

from sim.compliant.equilibrium import (
    EASE,
    _compliance,
    _derivatives,
    _step,
    blocks,
    motion,
    torque_of,
)
from tests.equilibria import SCALE, B, F, J, K, drawn_contact, law_of

CREEP = 1e-7  # of a leg's own compliance, where a foot cannot give way along the floor


@pytest.fixture
def contact():
    return drawn_contact()


@pytest.fixture
def guess():
    rng = np.random.default_rng(9)
    force = rng.normal(size=(B, F, K, 3))
    force[..., 2] = np.abs(force[..., 2])
    return rng.normal(size=(B, 6)) * 1e-3, force


def wrong(contact, twist, force, u):
    return law_of(contact).at(contact, twist, force, u).wrong


def test_points_move_by_body_joints_and_drift(contact, guess):
    twist, force = guess
    found = motion(contact, twist, force)
    for b, f, k, axis in np.ndindex(B, F, K, 3):
        row = 3 * k + axis
        torque = sum(
            force[b, f, m // 3, m % 3] * contact.lever[b, f, m] for m in range(3 * K)
        )
        best = contact.reach[b, f, row] @ twist[b] + contact.drift[b, f, row]
        best += contact.lever[b, f, row] @ (contact.yield_[b, f] * torque)
        assert found[b, f, k, axis] == pytest.approx(best)
        assert torque_of(contact.lever, force)[b, f] == pytest.approx(torque)
    still = motion(contact, twist, force, np.zeros((B, F, J)))
    none = replace(contact, yield_=0 * contact.yield_)
    assert still == pytest.approx(motion(none, twist, force))


def test_compliance_is_the_slope_of_motion_and_of_the_floor_over_force(contact, guess):
    twist, force = guess
    C = _compliance(contact, contact.yield_)
    for n in range(3 * K):
        more = force.copy().reshape(B, F, 3 * K)
        more[..., n] += 1.0
        moved = motion(contact, twist, more.reshape(force.shape)) - motion(
            contact, twist, force
        )
        column = moved.reshape(B, F, 3 * K)
        if n % 3 == 2:
            column[..., n] += contact.floor[..., n // 3]
        own = np.abs(column).max()
        assert np.abs(C[..., n] - column).max() < 10 * CREEP * own


def test_creep_keeps_points_that_cannot_give_way_regular(contact):
    stiff = replace(contact, lever=contact.lever * np.tile([0, 1, 1], K)[:, None])
    C = _compliance(stiff, stiff.yield_)
    along = np.arange(3 * K)
    plain = (stiff.lever * stiff.yield_[:, :, None]) @ np.swapaxes(stiff.lever, 2, 3)
    most = plain[..., along, along].max(axis=-1)
    assert C[..., 0, 0] == pytest.approx(CREEP * most)
    assert C[..., 1, 1] == pytest.approx(plain[..., 1, 1] + CREEP * most)
    free = replace(stiff, lever=0 * stiff.lever)
    assert (_compliance(free, free.yield_)[..., 0, 0] > 0).all()


def test_gaps_are_scaled_by_the_points_own_compliance(contact):
    C, law = _compliance(contact, contact.yield_), law_of(contact)
    for b, f, k in np.ndindex(B, F, K):
        own = [C[b, f, 3 * k + axis, 3 * k + axis] for axis in range(3)]
        assert law.normal[b, f, k] == pytest.approx(SCALE[0] / own[2])
        mean = (own[0] + own[1]) / 2
        assert law.tangent[b, f, k] == pytest.approx(SCALE[1] / mean)


def kinds(contact, guess):
    """Motions in which points stick, slide and are lifted."""
    twist, force = guess
    u = np.zeros_like(force)
    lifts = 1e-2 - contact.gap - contact.floor * force[..., 2]
    rests = -contact.gap - contact.floor * force[..., 2]
    u[..., 2] = rests
    u[0, ..., 2] = lifts[0]
    force = force.copy()
    force[1, ..., :2] *= 0.05  # well within the cone
    force[0] *= 0.01
    u[1, ..., :2] = -force[1, ..., :2] * 1e-5
    u[2, ..., :2] = -force[2, ..., :2] * 1e-4  # slides against friction
    return twist, force, u


def test_points_stick_slide_and_lift_as_they_are_meant_to(contact, guess):
    twist, force, u = kinds(contact, guess)
    state = law_of(contact).at(contact, twist, force, u)
    assert state.lifted[0].all()
    assert state.sticks[1].all()
    assert state.slides[2].all()
    each = state.lifted.astype(int) + state.sticks + state.slides
    assert (each == 1).all()


def test_derivatives_are_those_of_the_law_by_forces_and_motions(contact, guess):
    """Central differences, where no point changes to another part of the law."""
    twist, force, u = kinds(contact, guess)
    law, step = law_of(contact), 1e-7
    state = law.at(contact, twist, force, u)
    A, Q = _derivatives(contact, law, state)
    by_force = np.zeros_like(A)
    for axis in range(3):
        nudge = step * np.eye(3)[axis]
        ahead, back = (wrong(contact, twist, force + s * nudge, u) for s in (1, -1))
        by_force[..., axis] = (ahead - back) / (2 * step)
        nudge = nudge * 1e-3
        ahead, back = (wrong(contact, twist, force, u + s * nudge) for s in (1, -1))
        found = (ahead - back) / (2e-3 * step)
        assert Q[..., axis] == pytest.approx(
            found, rel=1e-4, abs=1e-3 * np.abs(Q).max()
        )
    # the floor's own compliance stands in the compliance matrix, as a motion
    floor = np.zeros_like(A)
    floor[..., 2, 2] = contact.floor
    assert A + Q @ floor == pytest.approx(by_force, rel=1e-5, abs=1e-6)


def test_a_step_of_newton_solves_the_linear_equations(contact, guess):
    """What forces and motions change by undoes what is wrong, to first order."""
    twist, force, u = kinds(contact, guess)
    law, C = law_of(contact), _compliance(contact, contact.yield_)
    state = law.at(contact, twist, force, u)
    dx, df = _step(contact, law, state, C)
    A, Q = _derivatives(contact, law, state)
    du = contact.reach @ dx[:, None, :, None] + C @ df[..., None]
    points = (*force.shape, 1)
    change = A @ df.reshape(points) + Q @ du.reshape(points)
    assert change[..., 0] == pytest.approx(-state.wrong, rel=1e-6, abs=1e-9)
    pulled = (np.swapaxes(contact.reach, 2, 3) @ df[..., None]).sum(axis=1)[..., 0]
    eased = contact.inertia + np.diag(EASE)
    balance = pulled - (eased @ dx[..., None])[..., 0]
    assert balance == pytest.approx(-state.unbalanced, rel=1e-6, abs=1e-9)


def test_blocks_multiply_every_point_on_its_own():
    rng = np.random.default_rng(1)
    Q, other = rng.normal(size=(B, F, K, 3, 3)), rng.normal(size=(B, F, 3 * K, 5))
    found = blocks(Q, other)
    for k in range(K):
        rows = slice(3 * k, 3 * k + 3)
        assert found[..., rows, :] == pytest.approx(Q[:, :, k] @ other[..., rows, :])


def test_some_lanes_are_taken_with_all_that_they_have(contact):
    some = contact.take(np.array([2, 0]))
    assert (some.drift == contact.drift[[2, 0]]).all()
    assert some.side is None
    one = replace(contact, number=np.arange(B)).take(np.array([1]))
    assert one.number == [1]
