"""Designs with fewer joints: all of them, each once."""

from math import comb

import pytest

from models.motion.robot_equations import equations
from sim.studies.designing import designs

WAYS = (3**3 - 1) // 2  # of three legs, mirrored ones once, at least one swinging


def test_six_legs_have_every_design_once():
    found = list(designs(range(1, 7)))
    assert len(found) == comb(6, 3) // 2 * WAYS**2
    assert len(set(map(str, found))) == len(found)
    assert [design.joints for design in found] == sorted(d.joints for d in found)
    assert (found[0].joints, found[-1].joints) == (2, 6)


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
