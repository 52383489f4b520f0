"""Borders of gaits, metrics, shapes and formulas: the first value that is refused."""

import re
from math import inf, nan

import numpy as np
import pytest
import sympy as sp

from planner.controllability.gaits import gait_controllability
from planner.errors import RangeError, StratumError
from planner.systems.flows import Flow, Gait, gait_steps, merged, places_in
from planner.systems.formulas import read_formula
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

OFF_STRATUM = 1e-9  # by which a configuration may miss the level sets
OVERSTEP = 1e-9  # excess over a range that is taken for rounding

STATE = sp.symbols("x y z")
WALKER = StratifiedSystem(
    "x y z",
    {"12": {}, "1": {"f": [1, 0, 0]}, "2": {"g": [0, 1, "x"]}, "0": {"h": [0, 0, 1]}},
    "12",
)


@pytest.mark.parametrize(
    ("gait", "message"),
    [
        ((), "a gait visits 1 to 1000 strata, got none (eq. 11)"),
        (("12",) * 1001, "a gait visits 1 to 1000 strata, got 1001 (eq. 11)"),
        (("12", "1"), "gait S12 -> S1 does not close: it starts in S12 and ends"),
        (("12", "2", "1", "12"), "gait S12 -> S2 -> S1 -> S12 steps from S2 to S1, wh"
                                 "ich are not neighbours; the neighbours of S2: S12, "),
        (("12", "7", "12"), "stratum '7' of gait S12 -> S7 -> S12"),
    ],
)  # fmt: skip
def test_gaits_are_closed_walks_from_neighbour_to_neighbour(gait, message):
    with pytest.raises(StratumError, match=f"^{re.escape(message)}"):
        Gait(WALKER, gait)
    assert Gait(WALKER, ("S12", "S12", "1", "12")).once_around == ("12", "12", "1")
    assert Gait(WALKER, ("12",)).once_around == ("12",)
    assert Gait(WALKER, (12, 1, 12)).strata == ("12", "1", "12")


def test_a_gait_is_followed_the_shorter_way_round():
    gait = ("12", "1", "0", "2", "12", "1", "12")
    flows = [Flow("1", "f", 1.0), Flow("2", "g", 1.0)]
    steps = gait_steps(WALKER, flows, gait, ("12", "12"))
    assert steps == (("1",), ("0", "2"), ("12",))
    assert places_in(gait, "1") == [1, 5]
    with pytest.raises(StratumError, match="the gait 12 1 12 does not visit S2, which"):
        places_in(("12", "1", "12"), "2")


def test_flows_that_follow_one_another_are_joined_and_dropped_if_they_cancel():
    flows = [Flow("1", "f", 1.0), Flow("1", "f", -1.0), Flow("2", "g", 0.0),
             Flow("1", "f", 0.5), Flow("1", "f", 0.25)]  # fmt: skip
    assert merged(flows) == (Flow("1", "f", 0.75),)


@pytest.mark.parametrize(("off", "refused"), [(0.99, False), (1.01, True)])
def test_a_gait_begins_in_its_first_stratum_but_for_rounding(off, refused):
    strata = {"1": {"f": [1, 0]}, "0": {"g": [1, 0], "up": [0, 1]}}
    system = StratifiedSystem("x h", strata, "1", {"1": ["h"]})
    at = (0.0, off * OFF_STRATUM)
    if refused:
        with pytest.raises(ValueError, match="is not in the gait's first stratum: h"):
            gait_controllability(system, ("1", "0", "1"), at)
    else:
        gait_controllability(system, ("1", "0", "1"), at)
    for wrong, message in (((0,), r"shape \(1,\), expected \(2,\): x, h"),
                           ((0, nan), "is not finite")):  # fmt: skip
        with pytest.raises(ValueError, match=message):
            gait_controllability(system, ("1", "0", "1"), wrong)


@pytest.mark.parametrize("weight", [0.0, -1.0, inf, nan])
def test_a_metric_has_lengths_above_zero(weight):
    strata = {"0": {"f": [1, 0, 0]}}
    message = f"metric has x = {weight}; give the length that a unit of it counts as"
    with pytest.raises(ValueError, match=re.escape(message)):
        StratifiedSystem("x y z", strata, "0", metric={"x": weight})
    system = StratifiedSystem("x y z", strata, "0", metric={"x": 2, "y": 1})
    assert system.metric == {"x": 2.0}
    assert system.length([[1, 0, 0], [3, 8, 0]]).tolist() == [2.0, 10.0]


SHAPE = ShapeCoordinates(
    StratifiedSystem("x p q", {"0": {"f": ["cos(q)", 1, 0], "g": [0, -2, 3]}}, "0")
)


@pytest.mark.parametrize(
    ("end", "kept"),
    [(0.5 + 0.9 * OVERSTEP, True), (0.5 + 1.1 * OVERSTEP, False),
     (-0.3 - 0.9 * OVERSTEP, True), (-0.3 - 1.1 * OVERSTEP, False)],
)  # fmt: skip
def test_flows_stay_within_a_range_but_for_rounding(end, kept):
    start = np.array([0.0, 0.1, 0.0])
    flows = [Flow("0", "f", end - 0.1), Flow("0", "g", (end - 0.2) / 2)]
    within = {"p": (-0.3, 0.5)}
    if kept:
        SHAPE.require_within(within, flows, start)
    else:
        with pytest.raises(RangeError, match="^p would reach"):
            SHAPE.require_within(within, flows, start)
    assert SHAPE.coordinates == {1, 2}
    assert SHAPE.inert == {1}
    assert SHAPE.recoveries == {}


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        (
            {"p": (1.0, 1.0)},
            "limits of p are empty: 1.0 to 1.0; give the lower one",
        ),
        ({"x": (0.0, 1.0)}, "limit of x: some field moves it at a rate that varies"),
        ({"w": (0.0, 1.0)}, "limit of w, which"),
    ],
)
def test_limits_name_shape_coordinates_low_before_high(limits, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        SHAPE.require_limits(limits)
    SHAPE.require_limits({"p": (-1.0, 1.0), "q": (0.0, 1e-9)})


@pytest.mark.parametrize(
    ("text", "taken"),
    [
        ("x" + " " * 9_999, True), ("x" + " " * 10_000, False),  # characters
        ("*".join("x" * 64), True), ("*".join("x" * 65), False),  # factors
        ("2**332 + x", True), ("2**333 + x", False),
        ("(1/3)**512", True), ("(1/3)**513", False), ("(1/3)**-513", False),
        ("9.9e99 + x", True), ("1e100 + x", False), ("-1e100 + x", False),
        ("True", False), ("x.real", False), ("sin(x, y=1)", False), ("+x", True),
    ],
)  # fmt: skip
def test_formulas_are_no_longer_than_what_can_be_worked_with(text, taken):
    if taken:
        read_formula(text, STATE)
    else:
        with pytest.raises(ValueError, match=r"formula|power|below"):
            read_formula(text, STATE)
