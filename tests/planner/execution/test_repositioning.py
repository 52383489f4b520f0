"""The order in which legs are set: standing throughout, and as cheap as any."""

import numpy as np
import pytest
from scipy.sparse import lil_array
from scipy.sparse.csgraph import dijkstra

from planner.execution.stepping import reposition_legs

LIFT_COST = 1.0  # of lifting a leg, in the unit of distances between places

PLACES = [np.array([-0.5, 0.1, 0.5]), np.array([0.0, 0.4]), np.array([-0.3, 0.0, 0.2])]
SIZES = [len(place) for place in PLACES]


def cost_of(moves, now):
    here, total = [p[i] for p, i in zip(PLACES, now, strict=True)], 0.0
    for leg, place in moves:
        total += LIFT_COST + abs(place - here[leg])
        here[leg] = place
    return total


def cheapest(steady, now, goal):
    """The same by a library, over a graph of all combinations of places."""
    nodes = list(np.ndindex(*SIZES))
    graph = lil_array((len(nodes), len(nodes)))
    for a, here in enumerate(nodes):
        for b, there in enumerate(nodes):
            moved = [i for i in range(len(SIZES)) if here[i] != there[i]]
            if len(moved) == 1 and steady[moved[0]][here] and steady[moved[0]][there]:
                place = PLACES[moved[0]]
                way = abs(place[here[moved[0]]] - place[there[moved[0]]])
                graph[a, b] = LIFT_COST + way
    return dijkstra(graph.tocsr(), indices=nodes.index(now))[nodes.index(goal)]


def test_where_others_always_stand_each_leg_moves_once_or_not_at_all():
    steady = np.ones((3, *SIZES), dtype=bool)
    moves = reposition_legs(PLACES, steady, (0, 0, 0), (2, 0, 1))
    assert sorted(moves) == [(0, 0.5), (2, 0.0)]
    assert reposition_legs(PLACES, steady, (0, 0, 0), (0, 0, 0)) == []


@pytest.mark.parametrize("seed", range(40))
def test_no_leg_lifts_or_lands_where_others_tip_and_no_sequence_is_cheaper(seed):
    random = np.random.default_rng(seed)
    steady = random.random((3, *SIZES)) < 0.6
    now, goal = (tuple(random.integers(SIZES)) for _ in range(2))
    moves, least = (
        reposition_legs(PLACES, steady, now, goal),
        cheapest(steady, now, goal),
    )
    if moves is None:
        assert np.isinf(least)
        return
    here = list(now)
    for leg, place in moves:
        assert steady[leg][tuple(here)]
        here[leg] = int(np.flatnonzero(PLACES[leg] == place)[0])
        assert steady[leg][tuple(here)]
    assert tuple(here) == tuple(goal)
    assert cost_of(moves, now) == pytest.approx(least)


def test_another_leg_stands_elsewhere_for_a_while():
    """Leg 2 can only lift while leg 1 is at its last place, where it is not to stay."""
    steady = np.ones((3, *SIZES), dtype=bool)
    steady[1][:2] = False
    moves = reposition_legs(PLACES, steady, (0, 0, 0), (0, 1, 0))
    assert moves == [(0, 0.5), (1, 0.4), (0, -0.5)]
