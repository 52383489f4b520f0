"""Searches end in time, and say how far they came."""

import numpy as np
import pytest

from planner.errors import BudgetError
from planner.numerics.collocation import follow
from planner.support.stopping import limited, tick


def search(seconds, *found):
    with limited(seconds):
        for best in found:
            tick(best)
        raise KeyboardInterrupt


def test_a_search_that_takes_too_long_says_the_best_it_found():
    with pytest.raises(BudgetError, match="none within 0 s; it had come to 3 segments"):
        search(0.0, "3 segments")


def test_the_best_is_kept_until_something_better_is_found():
    with pytest.raises(KeyboardInterrupt) as stop:
        search(60.0, "3 segments", "8 segments", "")
    assert stop.value.__notes__ == ["planning had come to 8 segments"]


def test_outside_of_a_limit_a_search_may_take_its_time():
    tick("anything")


def test_the_share_of_the_time_is_reported():
    told = []
    with limited(1e6, told.append):
        tick()
    assert 0 <= told[0] < 1e-3


def test_a_flow_that_is_halved_again_and_again_keeps_the_time():
    """Each half asks for the time, and a flow without end has very many of them."""
    with pytest.raises(BudgetError), limited(0.0):
        follow(lambda x: x * x, np.array([1.0]), 1.0)
