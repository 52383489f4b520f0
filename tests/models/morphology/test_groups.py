"""Legs of the shipped robots: where they point, and which of them move together."""

import numpy as np

from models import load
from models.morphology.mjcf import Leg
from models.morphology.shipped import EIGHT, FEET, RADIAL_BEARINGS, SIX


def apart(bearings):
    """Angles between neighbours all around [degrees]."""
    around = np.sort(np.mod(bearings, 360))
    return np.diff(around, append=around[0] + 360)


def test_legs_of_a_radial_robot_point_outward_evenly_and_groups_every_other_way():
    assert sorted(RADIAL_BEARINGS) == [*range(1, 7)]
    assert apart([*RADIAL_BEARINGS.values()]).tolist() == [60] * 6
    assert apart([RADIAL_BEARINGS[leg] for leg in SIX]).tolist() == [120] * 3
    left, right = (
        sum(b * way > 0 for b in RADIAL_BEARINGS.values()) for way in (1, -1)
    )
    assert left == right == 3
    assert all(RADIAL_BEARINGS[n] == -RADIAL_BEARINGS[n + 1] for n in (1, 3, 5))


def test_groups_of_six_legs_are_tripods_across_the_body():
    rows = [np.sign(FEET[leg][0]) for leg in SIX]
    sides = [np.sign(FEET[leg][1]) for leg in SIX]
    assert sorted(rows) == [-1, 0, 1]
    assert sides[rows.index(0)] == -sides[rows.index(1)] == -sides[rows.index(-1)]
    assert set(load("hexapod").card.groups["1"].legs) == set(SIX)


def test_groups_of_eight_legs_are_the_outer_ones_of_a_side_and_the_inner_of_the_other():
    assert set(load("octopod").card.groups["1"].legs) == set(EIGHT)
    left, right = ([leg in EIGHT for leg in range(first, 9, 2)] for first in (1, 2))
    assert left == [True, False, False, True]
    assert right == [not own for own in left]


def test_legs_stand_as_they_are_drawn_unless_they_are_turned():
    assert Leg((0.1, 0.1), (0.1, 0.2)) == Leg((0.1, 0.1), (0.1, 0.2), turned=0.0)
