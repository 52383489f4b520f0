"""Recoveries centre strokes whatever the rates of their fields are."""

import numpy as np
import pytest

from planner.execution.centring import centred
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem


def test_fields_that_recover_twice_or_four_times_as_fast_do_so_for_less_long():
    fields = {
        "12": {},
        "1": {"s1": [1, 0, 1, 0], "r2": [0, 0, 0, 2]},
        "2": {"s2": [0, 1, 0, 1], "r1": [0, 0, -4, 0]},
    }
    shape = ShapeCoordinates(StratifiedSystem("x y p q", fields, "12"))
    words = [[Flow("1", "s1", 0.3), Flow("2", "s2", -0.2)] * 2]
    (found,) = centred(shape, words, np.zeros(4), np.zeros(4), ("12", "12"))
    assert {"r1", "r2"} <= {flow.field for flow in found}
    for name, coordinate in (("s1", 2), ("s2", 3)):
        angles = shape.trajectory(coordinate, found, 0.0)
        assert angles[-1] == pytest.approx(0.0)
        for k, flow in enumerate(found):
            if flow.field == name:
                assert angles[k] + angles[k + 1] == pytest.approx(0.0)
