"""In which order points are walked, and which of them."""

import pytest

from sim.sweeps.file import read_sweep
from sim.sweeps.folder import About, Shard
from sim.sweeps.sweeping import GOLDEN
from tests.sweeps import write_sweep


def test_the_golden_ratio_divides_the_unit_interval_as_it_is_divided_itself():
    assert pytest.approx(1.0) == GOLDEN**2 + GOLDEN


def test_a_sweep_that_is_not_divided_has_all_points():
    assert all(point in Shard() for point in range(5))
    assert Shard().suffix == ""


def test_the_same_keys_in_another_order_are_another_sweep(tmp_path):
    """Their points have other numbers."""
    lines = ["friction = [0.5, 1.0]\n", "lift_height = [0.01, 0.02]\n"]
    files = [
        write_sweep(tmp_path, f"[grid]\n{''.join(varies)}", name)
        for name, varies in {"one": lines, "other": lines[::-1]}.items()
    ]
    one, other = (About.of(read_sweep(str(file))) for file in files)
    assert one.differences(one) == []
    assert one.differences(other) == [
        'order: ["friction", "lift_height"], now ["lift_height", "friction"]'
    ]
