"""Phases that no walk has are refused, and shares of ways that are none."""

from math import pi
from types import SimpleNamespace

import pytest

from models import load
from sim.evaluation.deviations import Scale
from sim.evaluation.flows import read, require_known, written
from sim.evaluation.phases import WalkedPhase
from sim.evaluation.quantities import CLAIMED, WRONG, Quantity, number
from sim.scenarios.body_path import line

CARD = load("hexapod").card
SWING = WalkedPhase(1, 0.0, 1.0, "swing", "12", "g12_1", 0.1, "1", 0.0, True)


def test_numbers_for_people_have_two_digits_and_quantities_none_unless_they_say_so():
    assert number(1.2345) == "1.23"
    assert Quantity("a", "length", "mm").words(1.2e-3) == "1 mm"
    assert [one.key for one in (WRONG, CLAIMED)] == [
        "feedback.wrong",
        "feedback.claimed",
    ]


def test_numbers_of_phases_are_below_a_billion():
    assert len(read(written([SWING._replace(end=0.99e9)]))) == 1
    with pytest.raises(ValueError, match="is not below 1e\\+09"):
        read(written([SWING._replace(end=1e9)]))


def test_a_phase_is_as_planned_or_it_is_not():
    with pytest.raises(ValueError, match=r"phase 0 of flows\.csv, '2' is not in list"):
        read(written([SWING]).replace(",1\n", ",2\n"))


def test_phases_take_time():
    with pytest.raises(ValueError, match=r"flows\.csv has a phase that takes no time"):
        read(written([SWING, SWING._replace(start=1.0, end=1.0 + 1e-7)]))
    assert len(read(written([SWING, SWING._replace(start=1.0, end=1.0 + 1e-6)]))) == 2


@pytest.mark.parametrize(("turns", "known"), [(1.99, True), (2.01, False)])
def test_joints_swing_by_two_turns_at_most_in_a_phase(turns, known):
    gains = [abs(g) for one in CARD.groups.values() for g in one.legs.values()]
    phase = SWING._replace(amount=2 * pi * turns / min(1.0, *gains))
    if known:
        require_known([phase], CARD)
    else:
        with pytest.raises(ValueError, match="what its robot does not do"):
            require_known([phase], CARD)


@pytest.mark.parametrize(("length", "kept"), [(0.9e-6, False), (1.1e-6, True)])
def test_shares_of_ways_shorter_than_a_micrometre_are_none(length, kept):
    path = SimpleNamespace(length=length, curve=line([length, 0.0, 0.0]).curve)
    assert Scale.of(path, 0.1, ["ideal"]).length == (length if kept else 0.0)
