"""Equilibria are what they claim, in physical units, and hard ones are found."""

from pathlib import Path

import numpy as np
import pytest

from sim.compliant.equilibrium import Contact, _newton, equilibrium, motion

# Problems of `line` at 50 and 1000 N m/rad that Newton's method does not solve where
# gaps count as much as forces over a leg's own stiffness.
HARD = Path(__file__).with_name("hard_problems.npz")


@pytest.fixture(scope="module")
def hard():
    stored = dict(np.load(HARD))
    guess = stored.pop("twist"), stored.pop("force")
    return Contact(**stored), *guess


def test_hard_problems_are_solved_on_the_first_scale(hard):
    assert _newton(*hard, (0.1, 0.05), None).holds.all()


def test_they_are_hard_on_the_scale_of_the_legs_themselves(hard):
    assert not _newton(*hard, (1.0, 1.0), None).holds.any()


def test_what_holds_keeps_the_cone_the_balance_and_what_sticks(hard):
    contact = hard[0]
    found = equilibrium(*hard)
    u, f = motion(contact, found.twist, found.force), found.force
    normal, along = f[..., 2], np.linalg.norm(f[..., :2], axis=-1)
    gap = contact.gap + u[..., 2] + contact.floor * normal
    pressed = normal > 1e-5
    assert normal.min() > -1e-6
    assert gap[~pressed].min() > -1e-9
    assert np.abs(gap[pressed]).max() < 1e-9
    assert (along - contact.friction * normal).max() < 1e-6
    way = np.linalg.norm(u[..., :2], axis=-1)
    inside = along < contact.friction * normal - 2e-6
    assert way[inside].max() < 2e-9  # both directions together
    slides = pressed & (way > 1e-6)
    opposed = (f[..., :2] * u[..., :2]).sum(-1)[slides] / (along * way)[slides]
    assert slides.any()
    assert opposed.max() < -1 + 1e-6
    pull = (np.swapaxes(contact.reach, 2, 3) @ f.reshape(*f.shape[:2], -1, 1)).sum(1)
    rest = (pull - contact.inertia @ found.twist[..., None])[..., 0] + contact.wrench
    assert np.abs(rest[:, :3]).max() < 1e-6


def test_an_equilibrium_does_not_depend_on_the_guess(hard):
    contact, twist, force = hard
    cold = equilibrium(contact, np.zeros_like(twist), np.zeros_like(force))
    warm = equilibrium(*hard)
    same = cold.holds & warm.holds
    assert same.mean() > 0.9
    assert np.abs(cold.twist - warm.twist)[same].max() < 1e-7


def test_one_without_solution_is_not_said_to_hold(hard):
    contact, twist, force = (part for part in hard)
    lifted = Contact(**{**vars(contact), "gap": contact.gap + 1.0})
    weightless = Contact(**{**vars(lifted), "inertia": 0 * contact.inertia})
    assert not equilibrium(weightless, twist, force).holds.any()
