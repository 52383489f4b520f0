"""Designs with fewer joints: all of them, each once."""

from itertools import combinations, islice, product
from math import comb

import pytest

from models.motion.robot_equations import equations
from sim.studies import designing
from sim.studies.designing import Design, count_designs, designs

WAYS = (3**3 - 1) // 2  # of three legs, mirrored ones once, at least one swinging


def test_six_legs_have_every_design_once():
    found = list(designs(range(1, 7)))
    assert len(found) == comb(6, 3) // 2 * WAYS**2
    assert len(set(map(str, found))) == len(found)
    assert [design.joints for design in found] == sorted(d.joints for d in found)
    assert (found[0].joints, found[-1].joints) == (2, 6)


def by_trial(legs):
    """All designs in their order: every sign of every leg tried, sorted by joints."""
    head, *rest = legs
    found = [
        Design((dict(zip(first, one)), dict(zip(second, two))))  # noqa: B905
        for size in range(3, len(legs) - 2)
        for others in combinations(rest, size - 1)
        for first in [(head, *others)]
        for second in [[leg for leg in rest if leg not in others]]
        for one in product((1, -1, 0), repeat=len(first))
        for two in product((1, -1, 0), repeat=len(second))
        if all(next(filter(None, signs), 0) == 1 for signs in (one, two))
    ]
    return sorted(found, key=lambda design: design.joints)


@pytest.mark.parametrize("legs", [6, 7])
def test_designs_come_in_one_order_and_are_counted_without_being_made(legs):
    found = [str(design) for design in designs(range(legs))]
    assert found == [str(design) for design in by_trial(range(legs))]
    assert count_designs(legs) == len(found)


def test_the_first_designs_of_many_legs_are_made_alone(monkeypatch):
    made = []

    def counted(groups):
        made.append(groups)
        assert len(made) < 10, "more designs than were asked for"
        return Design(groups)

    monkeypatch.setattr(designing, "Design", counted)
    assert len(list(islice(designs(range(40)), 3))) == 3


def test_four_legs_make_no_two_groups_that_stand():
    assert list(designs(range(1, 5))) == []


def test_the_shipped_hexapod_is_among_its_designs(hexapod):
    (own,) = (d for d in designs(hexapod.legs) if str(d) == "1+ 4+ 5+ | 2+ 3+ 6+")
    twists, shipped = equations(own.built(hexapod)).twists, equations(hexapod).twists
    assert twists["g1_1"] == pytest.approx([-rate for rate in shipped["g1_1"]])
    assert twists["g2_2"] == pytest.approx(shipped["g2_2"])


def test_a_locked_leg_stays_where_it_is(hexapod):
    one = next(d for d in designs(hexapod.legs) if str(d) == "1+ 40 50 | 2+ 30 60")
    robot = one.built(hexapod)
    assert one.joints == 2
    assert abs(robot.swing_gain[3]) <= 1e-6
    assert robot.card.gait == ("12", "1", "12", "2", "12")
