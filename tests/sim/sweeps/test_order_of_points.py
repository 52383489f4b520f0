"""In which order points are walked, and which of them."""

import pytest

from sim.sweeps.folder import Shard
from sim.sweeps.sweeping import GOLDEN


def test_the_golden_ratio_divides_the_unit_interval_as_it_is_divided_itself():
    assert pytest.approx(1.0) == GOLDEN**2 + GOLDEN


def test_a_sweep_that_is_not_divided_has_all_points():
    assert all(point in Shard() for point in range(5))
    assert Shard().suffix == ""
