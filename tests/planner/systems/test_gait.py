"""Walks along a gait: which strata are entered before each flow, and how few."""

import pytest
from hypothesis import given, settings, strategies as st

from planner import Gait, StratifiedSystem, StratumError
from planner.systems.flows import Flow, Word, contact_switches, gait_steps
from planner.systems.grouping import Grouper, regroup_in_gait

FIELDS = {"12": {}, "1": {"f": [1, 0, 0]}, "2": {"g": [0, 1, "x"]}}
GAIT = ("12", "1", "12", "2", "12")


@pytest.fixture(scope="module")
def walker():
    return StratifiedSystem("x y z", FIELDS, "12")


def flows(*strata):
    fields = {"1": "f", "2": "g"}
    return [Flow(stratum, fields[stratum], 1.0) for stratum in strata]


@pytest.mark.parametrize(
    ("wanted", "ends", "steps"),
    [
        ("12", ("12", "12"), [("1",), ("12", "2"), ("12",)]),
        ("21", ("12", "12"), [("2",), ("12", "1"), ("12",)]),  # begun in its middle
        ("11", ("12", "12"), [("1",), (), ("12",)]),  # where it is, it stays
        ("1", ("1", "12"), [(), ("12",)]),
        ("1", ("1", "1"), [(), ()]),
        ("12", ("12", "1"), [("1",), ("12", "2"), ("12", "1")]),  # past its end
        ("", ("12", "2"), [("2",)]),
        ("", ("12", "12"), [()]),
    ],
)
def test_strata_are_entered_in_the_order_of_the_gait(walker, wanted, ends, steps):
    found = gait_steps(walker, flows(*wanted), GAIT, ends)
    assert list(found) == steps
    changes = sum(1 for step in steps for _ in step)
    counted = contact_switches(walker, flows(*wanted), *ends, GAIT)
    assert counted == changes  # a foot each


@settings(deadline=None)
@given(st.text("12", min_size=1, max_size=9), st.integers(1, 5), st.booleans())
def test_no_walk_along_a_long_gait_has_fewer_steps(wanted, twice, last):
    """Whichever of its visits to the bottom stratum it begins with."""
    walker, ends = (
        StratifiedSystem("x y z", FIELDS, "12"),
        ("12", "2" if last else "12"),
    )
    cycle = ("12", "1") * twice + ("12", "2")
    steps = gait_steps(walker, flows(*wanted), (*cycle, "12"), ends)

    def count(place):  # step by step
        start = place
        for stratum in (*wanted, ends[1]):
            while cycle[place % len(cycle)] != stratum:
                place += 1
        return place - start

    starts = (place for place, stratum in enumerate(cycle) if stratum == "12")
    assert sum(map(len, steps)) == min(map(count, starts))
    assert [s[-1] for s in steps if s][-1:] in ([], [ends[1]])


def test_a_gait_goes_once_around():
    walker = StratifiedSystem("x y z", FIELDS, "12")
    assert Gait(walker, GAIT).once_around == GAIT[:-1]
    assert Gait(walker, ("12",)).once_around == ("12",)


@pytest.mark.parametrize("ends", [("12", "2"), ("2", "12")])
def test_a_stratum_that_the_gait_does_not_visit_is_named(walker, ends):
    with pytest.raises(StratumError, match=r"gait 12 1 does not visit S2, .* add it"):
        gait_steps(walker, flows("1"), ("12", "1", "12"), ends)


@pytest.mark.parametrize("fields", [("f", "g"), ("g", "f")])
def test_flows_of_a_stratum_that_the_gait_does_not_visit_are_refused(walker, fields):
    """All of them are looked at, since the walk would look for the place for ever."""
    grouper, word = Grouper(walker, lambda a, b: False), Word(fields, [1.0, 1.0])
    with pytest.raises(StratumError, match=r"gait 12 1 does not visit S2, .* add it"):
        regroup_in_gait(grouper, [[word]], ("12", "1", "12"), "12")
