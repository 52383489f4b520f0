"""Measured fields added up: those of the stratum, as far as they were confirmed."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models import IdentifiedTwists, MeasurementError
from models.motion.twists import FailedField, MeasuredField

ROUNDING_ANGLE = 1e-6  # [rad] by which angles may lie beyond the reach

REACH = 0.3
NOWHERE = np.zeros((1, 2))


def field(stratum, direction, twist=(0.1, 0.0, 0.5), reach=REACH):
    parts = tuple(Polynomial([value]) for value in twist)
    return MeasuredField(stratum, direction, 0.45, parts, 0.0, reach)


FIELDS = {"a": field("1", (1.0, 0.0)), "b": field("2", (0.0, 1.0), reach=0.1)}
TWISTS = IdentifiedTwists(FIELDS)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_field_is_taken_just_as_far_as_it_was_confirmed(side):
    rates = np.array([[1.0, 0.0]])
    for within in (0.0, 0.5, 1.0, 1.0 + 0.9 * ROUNDING_ANGLE / REACH):
        swing = np.array([[side * within * REACH, 9.0]])  # the other group's is free
        assert TWISTS("1", swing, rates) == pytest.approx(np.array([[0.1, 0.0, 0.5]]))
    beyond = np.array([[side * (REACH + 1.1 * ROUNDING_ANGLE), 0.0]])
    said = "field a swings to 0.3 rad, but is confirmed to 0.3 rad either way; plan"
    with pytest.raises(MeasurementError, match=said):
        TWISTS("1", beyond, rates)


def test_a_field_that_does_not_move_may_be_anywhere():
    far = np.array([[0.0, 9.0]])
    assert TWISTS("2", far, NOWHERE) == pytest.approx(np.zeros((1, 3)))
    with pytest.raises(MeasurementError, match="field b swings to 9 rad"):
        TWISTS("2", far, np.array([[0.0, 1.0]]))


def test_one_moment_of_many_is_enough_to_be_refused():
    swing = np.array([[0.0, 0.0], [-0.4, 0.0], [0.1, 0.0]])
    moving = np.array([[1.0, 0.0]] * 3)
    with pytest.raises(MeasurementError, match="field a swings to 0.4 rad"):
        TWISTS("1", swing, moving)
    moving[1] = 0.0  # when it stands still there
    assert TWISTS("1", swing, moving).shape == (3, 3)


def test_a_field_that_failed_is_missed_on_its_own_stratum_alone():
    twists = replace(TWISTS, failed={"c": FailedField("2", "it fell over")})
    assert twists("1", NOWHERE, NOWHERE).shape == (1, 3)
    said = "field c could not be measured: it fell over; take stiffer servos, or groups"
    with pytest.raises(MeasurementError, match=said):
        twists("2", NOWHERE, NOWHERE)


def test_a_field_of_which_nothing_is_known_beyond_its_span_goes_anywhere():
    parts = (Polynomial([0.1]),) * 3
    twists = IdentifiedTwists({"a": MeasuredField("1", (1.0, 0.0), 0.45, parts, 0.0)})
    assert twists("1", np.array([[9.0, 0.0]]), np.array([[1.0, 0.0]])).shape == (1, 3)
