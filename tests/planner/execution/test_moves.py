"""Legs that are moved one at a time: as cheaply as any way, and never tipping."""

import heapq
import re

import numpy as np
import pytest

from planner.errors import StratumError
from planner.execution.stepping import _Legs, reposition_legs
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

SHORTEST_RECOVERY = 1e-12  # a recovery shorter than this is a rounding error
LIFT_COST = 1.0  # of lifting a leg, in the unit of distances between places
MOST_PARTS = 32  # of a stroke; a robot that can reposition its legs needs fewer
STROKE_ROUNDING = 1e-9  # of a stroke that just fits its range


def cheapest(places, steady, now, goal):
    """The cost of the best way, by Dijkstra's method; None if there is none."""
    queue, seen = [(0.0, tuple(now))], set()
    while queue:
        cost, here = heapq.heappop(queue)
        if here == tuple(goal):
            return cost
        if here in seen:
            continue
        seen.add(here)
        for leg, own in enumerate(places):
            for place in range(len(own)):
                there = (*here[:leg], place, *here[leg + 1 :])
                if place != here[leg] and steady[leg][here] and steady[leg][there]:
                    way = LIFT_COST + abs(own[place] - own[here[leg]])
                    heapq.heappush(queue, (cost + way, there))
    return None


@pytest.mark.parametrize("seed", range(30))
def test_moves_are_the_cheapest_that_never_tip(seed):
    rng = np.random.default_rng(seed)
    sizes = rng.integers(2, 5, size=3)
    places = [np.sort(rng.normal(size=n)) for n in sizes]
    steady = rng.random((3, *sizes)) < 0.7
    now, goal = ([int(rng.integers(n)) for n in sizes] for _ in range(2))
    moves, least = reposition_legs(places, steady, now, goal), None
    least = cheapest(places, steady, now, goal)
    assert (moves is None) == (least is None)
    if moves is None:
        return
    here, cost = list(now), 0.0
    for leg, place in moves:
        there = int(np.flatnonzero(places[leg] == place)[0])
        assert there != here[leg]
        assert steady[leg][tuple(here)]
        cost += LIFT_COST + abs(place - places[leg][here[leg]])
        here[leg] = there
        assert steady[leg][tuple(here)]
    assert here == goal
    assert cost == pytest.approx(least)


@pytest.mark.parametrize(("far", "lifts"), [(0.95, 3), (1.05, 5)])
def test_a_lift_is_worth_a_unit_of_distance(far, lifts):
    """The first leg waits until the second is far aside, or two others a little."""
    places = [np.array([0.0, end]) for end in (1.0, far, 0.0, 0.0)]
    steady = np.ones((4, 2, 2, 2, 2), dtype=bool)
    steady[0] = False
    steady[0, :, 1] = steady[0, :, :, 1, 1] = True
    moves = reposition_legs(places, steady, [0, 0, 0, 0], [1, 0, 0, 0])
    assert len(moves) == lifts


STRATA = {
    "12": {"push": [1, 0.5, -0.25]},
    "1": {"back": [0, 0, -2]},
    "2": {"forth": [0, 4, 0]},
}
SHAPE = ShapeCoordinates(StratifiedSystem("x p q", STRATA, "12"))
WIDE = {"p": (-0.2, 0.3), "q": (-0.4, 0.4)}


def legs(start=(0, 0, 0), limits=WIDE, stable=None):
    return _Legs(SHAPE, np.array(start, dtype=float), limits, stable)


@pytest.mark.parametrize(
    ("duration", "parts"),
    [(0.1, 1), (0.8, 1), (-0.8, 1), (0.8 * (1 + 0.9 * STROKE_ROUNDING), 1),
     (0.8 * (1 + 1.1 * STROKE_ROUNDING), 2), (1.7, 3), (8.0, 10)],
)  # fmt: skip
def test_a_stroke_has_as_many_parts_as_its_range_around_zero_asks_for(duration, parts):
    found = legs((0.0, 0.1, -0.1))
    flows = list(found.stroke(Flow("12", "push", duration)))
    strokes = [flow for flow in flows if flow.field == "push"]
    assert [flow.duration for flow in strokes] == pytest.approx(
        [duration / parts] * parts
    )
    p, q = 0.1, -0.1
    for flow in flows:  # every part is centred on zero
        if flow.field == "push":
            assert p == pytest.approx(-0.5 * flow.duration / 2)
            assert q == pytest.approx(0.25 * flow.duration / 2)
            p, q = -p, -q
        else:
            p += 4 * flow.duration * (flow.field == "forth")
            q -= 2 * flow.duration * (flow.field == "back")
    assert found.now[1:] == pytest.approx([p, q])


def test_legs_that_are_nearly_there_stay():
    found = legs((0.0, 0.1, 0.2))
    aside = {1: 0.1 + 0.9 * SHORTEST_RECOVERY, 2: 0.2 - 1.1 * SHORTEST_RECOVERY}
    (flow,) = found.set(aside)
    assert (flow.field, flow.stratum) == ("back", "1")
    assert flow.duration == pytest.approx(0.55 * SHORTEST_RECOVERY, rel=1e-3)


def test_strokes_of_coordinates_without_a_recovery_are_refused():
    lacking = ShapeCoordinates(StratifiedSystem("x p q", {"12": STRATA["12"]}, "12"))
    found = _Legs(lacking, np.zeros(3), {"p": (-1.0, 1.0)}, None)
    message = "push moves p in a stroke, and no field is its recovery; the legs cannot"
    with pytest.raises(StratumError, match=message):
        list(found.stroke(Flow("12", "push", 1.0)))


@pytest.mark.parametrize("span", [(0.0, 0.3), (-0.2, 0.0), (0.1, 0.3)])
def test_strokes_are_around_zero_inside_their_range(span):
    message = f"around zero, which is not inside its range {span[0]:g} to {span[1]:g};"
    with pytest.raises(StratumError, match=re.escape(message)):
        list(legs(limits={"p": span}).stroke(Flow("12", "push", 1.0)))


def nowhere(strata, places):
    return np.zeros((len(strata), *map(len, places.values())), dtype=bool)


def test_legs_that_would_tip_wherever_they_are_cannot_be_moved():
    with pytest.raises(StratumError, match="from where they are all at zero: "):
        list(legs(stable=nowhere).stroke(Flow("12", "push", 0.1)))
    with pytest.raises(StratumError, match="without tipping from p = 0.1, q = 0"):
        legs((0, 0.1, 0), stable=nowhere).set({1: 0.2, 2: 0.0})


def test_a_stroke_is_divided_until_its_ends_can_be_stood_on():
    """The robot stands with its legs up to 0.03 from zero, and no farther."""
    asked = []

    def near(strata, places):
        asked.append(strata)
        grid = np.meshgrid(*places.values(), indexing="ij")
        free = np.max(np.abs(grid), axis=0) <= 0.03 + 1e-12
        return np.stack([free] * len(strata))

    flows = list(legs(limits={}, stable=near).stroke(Flow("12", "push", 0.6)))
    strokes = [flow for flow in flows if flow.field == "push"]
    assert len(strokes) == 5  # of 0.3 for p, 0.06 at a time
    assert asked[0] == ["2", "1"]
    longest = 0.06 / 0.5 * MOST_PARTS
    with pytest.raises(StratumError, match="the robot would tip"):
        list(legs(limits={}, stable=near).stroke(Flow("12", "push", 1.01 * longest)))
