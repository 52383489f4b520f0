"""Equilibria are what they claim, in physical units, and hard ones are found."""

from pathlib import Path

import numpy as np
import pytest

from sim.compliant.equilibrium import Contact, _newton, equilibrium
from tests.equilibria import require_equilibrium

# Problems of `line` at 50 and 1000 N m/rad that Newton's method does not solve where
# gaps count as much as forces over a leg's own stiffness.
HARD = Path(__file__).with_name("hard_problems.npz")


@pytest.fixture(scope="module")
def hard():
    stored = dict(np.load(HARD))
    guess = stored.pop("twist"), stored.pop("force")
    return Contact(push=np.zeros_like(stored["gap"]), **stored), *guess


def test_hard_problems_are_solved_on_the_first_scale(hard):
    assert _newton(*hard, (0.1, 0.05), None).holds.all()


def test_they_are_hard_on_the_scale_of_the_legs_themselves(hard):
    assert not _newton(*hard, (1.0, 1.0), None).holds.any()


def test_what_holds_keeps_the_cone_the_balance_and_what_sticks(hard):
    assert require_equilibrium(hard[0], equilibrium(*hard))


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
