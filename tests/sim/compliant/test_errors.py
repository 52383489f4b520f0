"""How far a guess is from equilibrium, in newtons and metres."""

from dataclasses import replace

import numpy as np
import pytest

from sim.compliant.equilibrium import Contact, equilibrium, motion
from tests.equilibria import drawn_contact, law_of

ARM = 0.1
FORCE = 1e-6
WAY = 1e-9


@pytest.fixture
def contact():
    return drawn_contact()


def resting():
    """One point on the floor that bears 10 N straight down, and is at rest."""
    reach = np.zeros((1, 1, 3, 6))
    reach[0, 0, :, :3] = np.eye(3)
    lever = np.zeros((1, 1, 3, 3))
    lever[0, 0] = np.eye(3)
    one = np.ones((1, 1, 1))
    contact = Contact(
        reach=reach,
        lever=lever,
        yield_=1e-3 * np.ones((1, 1, 3)),
        drift=np.array([[[0.0, 0.0, -0.01]]]),  # the spring gives way by as much
        gap=-1e-3 * one,  # and the floor by this
        floor=1e-4 * one,
        friction=0.5 * one,
        wrench=np.array([[0.0, 0.0, -10.0, 0.0, 0.0, 0.0]]),
        inertia=np.zeros((1, 6, 6)),
        push=0.2 * one,
    )
    return contact, np.zeros((1, 6)), np.array([[[[0.0, 0.0, 10.0]]]])


def error(contact, twist, force):
    law = law_of(contact)
    return law.at(contact, twist, force, motion(contact, twist, force))


def test_what_is_in_equilibrium_has_no_error():
    state = error(*resting())
    assert state.error == pytest.approx([0.0], abs=1e-3)
    assert state.sticks.all()


@pytest.mark.parametrize("axis", range(6))
def test_an_unbalanced_wrench_counts_in_newtons_and_at_an_arm(axis):
    contact, twist, force = resting()
    allowed = FORCE if axis < 3 else FORCE * ARM
    wrench = contact.wrench.copy()
    wrench[0, axis] += 3.0 * allowed
    state = error(replace(contact, wrench=wrench), twist, force)
    assert state.error == pytest.approx([3.0], rel=1e-2)


def test_a_body_that_gathers_speed_is_balanced_by_its_inertia():
    contact, twist, force = resting()
    twist = twist.copy()
    twist[0, 4] = 1e-3
    inertia = np.zeros((1, 6, 6))
    inertia[0, 4, 4] = 5.0
    turned = replace(
        contact, inertia=inertia, wrench=contact.wrench + [0, 0, 0, 0, 5e-3, 0]
    )
    assert error(turned, twist, force).error == pytest.approx([0.0], abs=1e-3)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_gap_or_a_way_of_a_sticking_point_counts_in_metres(axis):
    contact, twist, force = resting()
    drift = contact.drift.copy()
    drift[0, 0, axis] += 4.0 * WAY
    state = error(replace(contact, drift=drift), twist, force)
    assert state.error == pytest.approx([4.0], rel=1e-2)


def test_forces_beyond_the_cone_and_of_lifted_points_count_in_newtons():
    contact, twist, force = resting()
    lifted = replace(contact, gap=contact.gap + 1.0)
    assert error(lifted, twist, force).error == pytest.approx([10.0 / FORCE])
    side = force.copy()
    side[..., 0] = 0.5 * 10.0 + 7 * FORCE
    rubbing = replace(
        contact, wrench=contact.wrench - [[side[0, 0, 0, 0], 0, 0, 0, 0, 0]]
    )
    rubbing = replace(
        rubbing, drift=rubbing.drift - [[[1e-3 * side[0, 0, 0, 0], 0, 0]]]
    )
    assert error(rubbing, twist, side).error == pytest.approx([7.0], rel=1e-2)


@pytest.mark.parametrize("push", [0.0, 0.2, 0.5])
def test_a_foot_that_slides_is_lifted_in_proportion(push):
    """A point is dragged by 1 mm: friction is mu times the normal force, against it."""
    contact, twist, force = resting()
    stiff = np.zeros((1, 6, 6))
    stiff[0, range(6), range(6)] = 1e9  # the body does not move
    dragged = replace(
        contact,
        inertia=stiff,
        wrench=np.zeros((1, 6)),
        drift=np.array([[[0.02, 0.0, -0.01]]]),
        push=np.full((1, 1, 1), push),
    )
    found = equilibrium(dragged, twist, force)
    assert found.holds.all()
    (x, y, z), (ux, _, uz) = (
        found.force[0, 0, 0],
        motion(dragged, found.twist, found.force)[0, 0, 0],
    )
    assert ux > 5e-3
    assert (x, y) == pytest.approx((-0.5 * z, 0.0), abs=1e-5)
    assert -1e-3 + uz + 1e-4 * z == pytest.approx(push * ux, abs=1e-8)
    assert ux == pytest.approx(0.02 - 1e-3 * 0.5 * z, abs=1e-7)
