"""Plans, the segments that they need, and what is refused of them."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BoundError, PlannerError, RangeError
from planner.execution.execution import Execution
from planner.planning import algorithm
from planner.planning.algorithm import Plan, with_remedy
from planner.planning.paths import line
from planner.planning.subdivision import Slack, needed, refined, subdivide
from planner.support import stopping
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

MOST_TRIED = 10_000  # segments, where a plan needs more of them to keep its limits

PLAIN = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")
ORDER = Execution(coordinates="backward")


def range_error():
    return RangeError("phi", 2.0, -1.0, 1.0)


def remedied(monkeypatch, enough, within=True):
    """The number of segments that is suggested where so many are enough."""
    tried = []

    def follow(extended, path, segments, execution):
        tried.append(segments)
        if segments < enough:
            raise range_error()
        return "plan"

    def require(limits, flows, end):
        if not within:
            raise range_error()

    monkeypatch.setattr(algorithm, "follow_path", follow)
    extended = SimpleNamespace(shape=SimpleNamespace(require_within=require))
    found = with_remedy(range_error(), extended, line([0], [1]), 5, ORDER)
    return found, tried


@pytest.mark.parametrize("enough", [6, 7, 10, 11, 20, 21, 33, 160])
def test_the_fewest_segments_that_suffice_are_suggested(monkeypatch, enough):
    found, tried = remedied(monkeypatch, enough)
    assert found.segments == enough
    assert max(tried) < 4 * enough
    assert min(tried) > 5


def test_where_no_number_of_segments_suffices_none_is_suggested(monkeypatch):
    found, tried = remedied(monkeypatch, 1, within=False)
    assert (found.segments, tried) == (None, [])
    assert "no number of segments suffices" in str(found)
    found, tried = remedied(monkeypatch, 10**9)
    assert found.segments is None
    assert f"{max(tried)} segments do not suffice" in str(found)
    assert MOST_TRIED / 2 < max(tried) <= MOST_TRIED


STANDING = np.array([0.4, 0.4, 0.4, 0.4])


@pytest.mark.parametrize(
    ("walking", "law", "pieces"),
    [
        ([0.0, 1e-9, 0.1, 0.4], 0.5, [1, 1, 1, 1]),
        ([-1e-9, -0.01, -0.15, -4.0], 0.5, [2, 2, 2, 3]),
        ([-0.17, -0.29, -0.3, -9.0], 0.5, [3, 3, 3, 3]),
        ([-1e-9, -0.39, -0.41, -9.0], 1.0, [2, 2, 3, 3]),
    ],
)
def test_a_segment_is_cut_into_as_many_pieces_as_its_departure_asks_for(
    walking, law, pieces
):
    slack = Slack("width", 0.0, STANDING, np.array(walking), law)
    assert needed(slack).tolist() == pieces


def test_segments_are_cut_into_equal_pieces():
    found = refined(np.array([0.0, 0.3, 1.0]), np.array([3, 1]))
    assert found == pytest.approx([0.0, 0.1, 0.2, 0.3, 1.0])


def test_what_is_kept_is_told_while_segments_are_cut():
    told = []

    def slacks(cuts):
        sizes = np.diff(cuts)
        full = np.full(len(sizes), 0.4)
        return [
            Slack("clearance", 0.1, full, 0.4 - sizes, unit="m"),
            Slack("length", 0.0, full, full),
        ]

    with stopping.limited(1e9):
        found = subdivide(np.array([0.0, 1.0]), slacks)
        told.append(stopping.best_so_far())
    assert np.diff(found).max() <= 0.4
    assert told == ["1 segments, which keep clearance of -0.5 m"]


@pytest.mark.parametrize(
    ("unit", "message"),
    [
        ("", "the width needs {many}; give a shorter path"),
        ("m", "width of 0.1 m would need {many}; -0.3 m is kept with 2: ask for less"),
    ],
)
def test_bounds_that_need_too_many_segments_are_refused(unit, message, monkeypatch):
    def slacks(cuts):
        return [
            Slack("length", 0.0, np.ones(2), np.ones(2)),
            Slack("width", 0.1, np.ones(2), np.array([0.2, -0.4]), unit=unit),
        ]

    monkeypatch.setattr("planner.planning.subdivision.MOST_DIVIDED", 2)
    with pytest.raises(BoundError) as refused:
        subdivide(np.array([0.0, 0.5, 1.0]), slacks)
    many = "more than 2 segments, above all between s = 0.5 and 1 of the path"
    assert str(refused.value) == message.format(many=many)


FLOWS = (Flow("0", "f", 1.0), Flow("0", "g", 2.0), Flow("0", "f", -1.0))
GIVEN = {
    "system": PLAIN, "elements": ("f", "g"), "basis": ("f", "g"), "flows": FLOWS,
    "segment_ends": (1, 3), "inputs": np.zeros((2, 4, 2)), "depart": "0", "arrive": "0",
    "hall_coordinates": np.zeros((2, 2)), "nominal": np.zeros((3, 2)),
}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"segment_ends": (1, 2)},
            "segment_ends do not ascend to the number of flows, 3",
        ),
        ({"segment_ends": (4, 3)}, "segment_ends do not ascend"),
        ({"segment_ends": (-1, 3)}, "segment_ends do not ascend"),
        (
            {"nominal": np.zeros((2, 2))},
            r"nominal of shape \(2, 2\) should be \(3, 2\)",
        ),
        ({"nominal": np.full((3, 2), np.nan)}, r"nominal .* finite numbers"),
        ({"hall_coordinates": np.zeros((2, 3))}, r"hall_coordinates of shape \(2, 3\)"),
        ({"inputs": np.zeros((2, 4, 3))}, r"inputs .* should be \(2, 4, 2\) finite"),
        ({"inputs": np.zeros((3, 4, 2))}, r"inputs .* should be \(2, 4, 2\) finite"),
        ({"depart": "7"}, "stratum '7'"),
        ({"arrive": "7"}, "stratum '7'"),
    ],
)
def test_plans_that_contradict_themselves_are_refused(changes, message):
    plan = Plan(**GIVEN)
    assert [len(part) for part in plan.segments()] == [1, 2]
    assert repr(plan) == "<Plan: 2 segments, 3 flows, 0 contact switches>"
    with pytest.raises((ValueError, PlannerError), match=message):
        Plan(**{**GIVEN, **changes})


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 30])
def test_of_many_segments_the_first_are_written_and_the_last(count):
    changes = {
        "flows": FLOWS[:1] * count, "segment_ends": tuple(range(1, count + 1)),
        "inputs": np.zeros((count, 1, 2)), "hall_coordinates": np.zeros((count, 2)),
        "nominal": np.zeros((count + 1, 2)),
    }  # fmt: skip
    head, *lines = str(Plan(**{**GIVEN, **changes})).splitlines()
    assert head.startswith(f"{count} segment{'s' if count > 1 else ''}, {count} flows,")
    numbers = [line.split()[0] for line in lines]
    shown = 3  # before the last one
    if count <= shown + 1:
        assert numbers == [str(k) for k in range(1, count + 1)]
    else:
        assert numbers == [*map(str, range(1, shown + 1)), "and", str(count)]
        assert f"and {count - shown - 1} more; segments() has them all" in lines[shown]
    assert lines[-1].split() == [str(count), "S0", "+1", "f"]
