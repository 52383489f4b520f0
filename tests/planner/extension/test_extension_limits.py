"""How far elements must point apart, and what a direction may miss and cost."""

from math import inf

import numpy as np
import pytest

from planner.errors import RankError
from planner.extension.choice import choose_elements
from planner.extension.direction_costs import DirectionCost, _cost
from tests.systems import flat_power


def test_brackets_are_tried_to_degree_four_unless_more_is_asked_for():
    assert len(choose_elements(flat_power(3), (0, 0)).elements) == 3
    with pytest.raises(RankError):
        choose_elements(flat_power(4), (0, 0))
    assert len(choose_elements(flat_power(4), (0, 0), 5).elements) == 3


@pytest.mark.parametrize(("strokes", "theory"), [(10_000.0, False), (10_000.1, True)])
def test_a_direction_of_more_than_ten_thousand_strokes_is_one_in_theory(
    strokes, theory
):
    assert DirectionCost("x", "f", strokes).in_theory_only == theory


@pytest.mark.parametrize(("aside", "strokes"), [(0.9e-6, 1.0), (1.1e-6, inf)])
def test_an_element_gives_a_direction_if_it_misses_a_millionth_of_a_unit(
    aside, strokes
):
    found = _cost("x", 0, np.array([[1.0], [aside]]), np.array([1]), ["f"])
    assert found.strokes == pytest.approx(strokes)
