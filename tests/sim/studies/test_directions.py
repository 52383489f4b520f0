"""Directions that two strokes and their bracket make, of twists that are known."""

import numpy as np
import pytest

from sim.studies import designing
from sim.studies.designing import Design, designs, directions

DESIGN = Design(({1: 1, 2: 1, 3: 1}, {4: 1, 5: -1, 6: 0}))


@pytest.mark.parametrize(
    ("first", "second", "made"),
    [
        ((1, 0, 0), (0, 1, 0), ("ahead", "aside")),  # nothing turns
        ((1, 0, 0), (0, 0, 1), ("ahead", "aside", "round")),  # a bracket leads aside
        ((0, 1, 0), (0, 0, 1), ("ahead", "aside", "round")),
        ((1, 0, 0), (2, 0, 0), ("ahead",)),
        ((0, 0, 1), (0, 0, 3), ("round",)),
        ((1, 1, 1), (2, 2, 2), ()),  # both about one pivot, which is elsewhere
        ((1, 2, 1), (-2, -4, -2), ()),
        ((0, 1, 1), (0, 3, 3), ()),
        ((1, 2, 1), (2, 1, 2), ("ahead", "aside", "round")),
        ((-4e-8, 0, -6e-7), (1e-8, 4e-8, 6e-7), ()),  # of the gains of locked legs
    ],
)
def test_a_bracket_makes_what_two_motions_do_not(first, second, made):
    """Of turns about one pivot it is none, since they commute."""
    known = dict(
        zip(
            (tuple(g.items()) for g in DESIGN.groups),
            map(np.array, (first, second)),
            strict=True,
        )
    )
    robot = type(
        "R", (), {"alternating": lambda self, groups: self, "groups": ("1", "2")}
    )()
    assert directions(robot, DESIGN, known) == made


def test_legs_that_do_not_stand_make_nothing(monkeypatch):
    first, second = (tuple(g.items()) for g in DESIGN.groups)
    robot = type(
        "R", (), {"alternating": lambda self, groups: self, "groups": ("1", "2")}
    )()
    assert directions(robot, DESIGN, {first: None, second: np.ones(3)}) == ()
    assert designing.STANDING == 3


def test_designs_are_told_by_legs_and_ways_and_come_with_few_joints_first():
    assert str(DESIGN) == "1+ 2+ 3+ | 4+ 5- 60"
    assert DESIGN.joints == 5
    found = list(designs((1, 2, 3, 4, 5, 6)))
    joints = [design.joints for design in found]
    assert joints == sorted(joints)
    assert joints[0] == 2
    assert joints[-1] == 6
    # ten ways to halve the legs; of 27 ways of three legs 13 are no mirrored ones
    assert len(found) == 10 * 13 * 13
    assert all(len(d.groups[0]) == len(d.groups[1]) == 3 for d in found)
    assert all(1 in d.groups[0] for d in found)
