"""How many groups, labels and reasons a study has, and what it counts as rounding."""

import numpy as np
import pytest

from sim.errors import UsageError
from sim.studies import maps
from sim.studies.designing import Design, designs
from sim.studies.findings import group
from sim.studies.results import ROUND, _require
from sim.studies.sensitivities import MILLIMETRE, NEWTON


@pytest.mark.parametrize(
    ("points", "groups"), [(12, 12), (13, 4), (59, 4), (60, 5), (288, 24), (900, 24)]
)
def test_twelve_values_are_groups_and_more_are_grouped_by_dozens_in_4_to_24_groups(
    points, groups
):
    found = group(np.linspace(0.0, 1.0, points).tolist())
    assert len(set(found.tolist())) == groups
    assert np.ptp(np.bincount(found)) <= 1


def test_values_are_kept_apart_only_where_that_is_asked_for():
    values = np.linspace(0.0, 1.0, 50).tolist()
    assert group(values).tolist() == group(values, separate=False).tolist()
    assert group(values, separate=True).tolist() == list(range(50))


def test_numbers_of_a_table_are_from_zero_to_a_million_millions():
    _require("a", [0.0, 1e12], "numbers", float)
    for wrong in (-1e-9, 1.01e12):
        with pytest.raises(UsageError, match="row 0 of column 'a'"):
            _require("a", [wrong], "numbers", float)


@pytest.mark.parametrize(("letters", "shown"), [(60, 60), (61, 45)])
def test_labels_have_sixty_letters_at_most(letters, shown):
    (label,) = maps._labels(["x" * letters]).values()
    assert len(label) == shown


def test_groups_of_a_design_have_three_legs_at_least_and_legs_that_swing_or_not():
    sizes = {len(signs) for one in designs(range(1, 8)) for signs in one.groups}
    assert sizes == {3, 4}
    signs = {
        sign for one in designs(range(6)) for g in one.groups for sign in g.values()
    }
    assert signs == {1, -1, 0}


def test_units_of_changes_are_those_that_are_named():
    assert (1000 * MILLIMETRE, NEWTON) == (1.0, 1.0)


def test_a_leg_that_does_not_swing_has_a_millionth_of_its_group_s_angle():
    given = []

    class Robot:
        def alternating(self, groups):
            given.append(groups)

    Design(({1: 1, 2: 0}, {3: -1})).built(Robot())
    assert given == [{"1": {1: 1, 2: 1e-6}, "2": {3: -1}}]


def test_round_limits_are_a_fifth_to_a_third_apart_from_a_billionth_to_thousands():
    """So that some round number lies close above any share of a path."""
    ratios = ROUND[1:] / ROUND[:-1]
    assert ratios.min() > 1.19
    assert ratios.max() < 1.34
    assert ROUND[[0, -1]] == pytest.approx([1e-9, 8e3])
    assert len(ROUND) == 10 * 13  # ten in each decade
