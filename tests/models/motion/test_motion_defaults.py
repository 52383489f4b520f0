"""What equations of motion are exact about, and what they assume by default."""

import sympy as sp

from models.motion.equations_of_motion import (
    Swing,
    _exact,
    walking_system,
)
from models.motion.twists import MeasuredField, QuasiStaticTwists

CONTACTS = (("12", ("1", "2")), ("1", ("1",)), ("2", ("2",)))
SWINGS = (Swing("12", "a", (1, 0), (0.1, 0, 0)), Swing("1", "b", (0, 1), None))


def test_whole_numbers_are_integers_as_long_as_floats_hold_each_of_them():
    assert _exact(2.0**53 - 1) == sp.Integer(2**53 - 1)
    assert _exact(2.0**53 - 1).is_Integer
    assert not _exact(2.0**53).is_Integer
    assert not _exact(0.5).is_Integer


def test_walking_systems_have_heights_and_angles_count_as_the_way_at_a_unit():
    plain = walking_system(("1", "2"), CONTACTS, SWINGS)
    given = walking_system(("1", "2"), CONTACTS, SWINGS, heights=True, radius=1.0)
    assert plain.state == given.state
    assert plain.metric == given.metric
    assert plain.strata == given.strata
    assert len(walking_system(("1", "2"), CONTACTS, SWINGS, heights=False).state) == 5


def test_a_swing_in_the_air_does_not_move_the_body():
    field = walking_system(("1", "2"), CONTACTS, SWINGS).strata["1"]["g1_b"]
    assert [*field] == [0, 0, 0, 0, 1, 0, 0]


def test_friction_is_coulomb_s_and_measured_fields_miss_nothing_unless_it_is_said():
    assert QuasiStaticTwists(None, None).swing_speed == 0
    assert MeasuredField("1", (1.0,), 0.25, (), 0.0).off == 0
