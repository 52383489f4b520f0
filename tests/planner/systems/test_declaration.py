"""What describes a system is brought to one form, or refused by its name."""

from math import inf, nan

import pytest
import sympy as sp

from planner.systems.declaration import (
    checked_level_sets,
    checked_lifts,
    checked_metric,
    checked_state,
    checked_strata,
)
from tests.systems import X, Y

STRATA = {"12": {}, "1": {"f": [1, 0]}, "2": {"g": [0, 1], "h": ["x*y", 2]}}


@pytest.mark.parametrize("state", ["x y", "x, y", ["x", "y"], [X, "y"], (X, Y)])
def test_a_state_is_given_by_names_or_symbols(state):
    assert checked_state(state) == (X, Y)


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ("", "state is empty"),
        ("x 2y", "has 2y, which is not a name"),
        ([X, X * Y], "not a name"),
        ("x sin", "has sin, which formulas use"),
        ("x y x", "names x twice"),
    ],
)
def test_a_state_that_cannot_be_is_refused(state, said):
    with pytest.raises(ValueError, match=said):
        checked_state(state)


def test_fields_become_columns_and_a_stratum_may_have_none():
    checked = checked_strata(STRATA, (X, Y))
    assert list(checked) == ["12", "1", "2"]
    assert checked["12"] == {}
    assert checked["2"]["h"] == sp.ImmutableMatrix([X * Y, 2])


@pytest.mark.parametrize(
    ("strata", "said"),
    [
        ({}, "strata hold no fields"),
        ({"0": {}}, "strata hold no fields"),
        ({"0": {"f": [1, 0], "f ": [0, 1]}}, "field name 'f ' of S0"),
        ({"1": {"f": [1, 0]}, "2": {"f": [0, 1]}}, "field f is in S1 and S2"),
        ({"0": {"f": [1, 0, 0]}}, r"shape \(3, 1\), expected \(2, 1\)"),
        ({"0": {"f": [1, sp.Symbol("z")]}}, "field f of S0 uses z, which is not in"),
        ({"0": {"f": [1, sp.sqrt(-1)]}}, "field f of S0 has I, no real number"),
        ({"0": {"f": [1, sp.oo]}}, "field f of S0 has oo, no real number"),
    ],
)
def test_fields_that_cannot_be_are_refused(strata, said):
    with pytest.raises(ValueError, match=said):
        checked_strata(strata, (X, Y))


def test_lengths_of_one_are_those_of_coordinates_that_are_not_named():
    assert checked_metric({"x": 2, "y": 1}, (X, Y)) == {"x": 2.0}
    assert checked_metric({X: 1e-300}, (X, Y)) == {"x": 1e-300}


@pytest.mark.parametrize("weight", [0.0, -1.0, inf, nan])
def test_a_unit_counts_as_some_length(weight):
    with pytest.raises(ValueError, match="metric has y = .*; give the length"):
        checked_metric({"y": weight}, (X, Y))


def test_one_lift_or_several_are_fields_of_their_stratum():
    assert checked_lifts({"2": "g"}, STRATA) == {"2": ("g",)}
    assert checked_lifts({"2": ["g", "h"]}, STRATA) == {"2": ("g", "h")}
    with pytest.raises(ValueError, match="lift 'f' of S2"):
        checked_lifts({"2": ["g", "f"]}, STRATA)
    with pytest.raises(ValueError, match="lifts of stratum '3'"):
        checked_lifts({"3": "g"}, STRATA)


def test_level_sets_are_independent_and_smooth():
    found = checked_level_sets(
        {"1": "x", "2": ["x", "x + y"], "12": []}, STRATA, (X, Y)
    )
    assert found == {"1": (X,), "2": (X, X + Y), "12": ()}
    with pytest.raises(ValueError, match="level sets of S2 are not independent: x, 2"):
        checked_level_sets({"2": ["x", "2*x"]}, STRATA, (X, Y))
    with pytest.raises(ValueError, match="level set of stratum '3'"):
        checked_level_sets({"3": "x"}, STRATA, (X, Y))
