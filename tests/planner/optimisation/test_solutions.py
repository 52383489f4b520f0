"""Solutions are cut at a place on the path, and joined again."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.execution.execution import Execution
from planner.optimisation import optimise
from planner.optimisation.task import Solution
from planner.planning.paths import line

WHOLE = Solution(
    first=0,
    strokes=np.array([1.0, 2.0, 3.0, 4.0]),
    recoveries=np.array([[1.0], [2.0], [3.0], [4.0]]),
    states=np.arange(10.0).reshape(5, 2),
    places=np.array([0.0, 0.2, 0.5, 0.7, 1.0]),
    cost=10.0,
    width=0.3,
)


@pytest.mark.parametrize(
    ("place", "stages"), [(0.0, 1), (0.1, 1), (0.3, 2), (0.6, 3), (0.8, 4), (1.0, 4)]
)
def test_a_solution_is_cut_after_the_stage_that_passes_a_place(place, stages):
    cut = WHOLE.until(place)
    assert len(cut.strokes) == len(cut.recoveries) == stages
    assert len(cut.states) == len(cut.places) == stages + 1
    assert cut.places[-2] <= place <= cut.places[-1]


def test_what_was_cut_is_joined_again():
    rest = Solution(
        first=2,
        strokes=WHOLE.strokes[2:],
        recoveries=WHOLE.recoveries[2:],
        states=WHOLE.states[2:],
        places=WHOLE.places[2:],
        cost=7.0,
        width=0.2,
    )
    joined = Solution.joined([WHOLE.until(0.3), rest])
    for name in ("strokes", "recoveries", "states", "places"):
        assert getattr(joined, name).tolist() == getattr(WHOLE, name).tolist()
    assert (joined.first, joined.width) == (0, 0.3)


def test_a_stage_that_is_repeated_recovers_nothing_the_second_time():
    strokes = np.array([5.0, 6.0, 7.0])
    guess = WHOLE.rearranged([2, 0, 2], strokes)
    assert guess.strokes is strokes
    assert guess.recoveries.tolist() == [[3.0], [1.0], [0.0]]
    # stages end where they ended, and no stage goes back on the path
    assert guess.states.tolist() == WHOLE.states[[0, 3, 1, 3]].tolist()
    assert guess.places.tolist() == [0.0, 0.7, 0.7, 0.7]


def test_a_hop_moves_inserts_or_removes_one_turn_of_the_cycle():
    seen = set()
    for seed in range(40):
        found = WHOLE.hopped(2, np.random.default_rng(seed))
        size = len(found.strokes)
        assert len(found.states) == len(found.places) == size + 1
        if size == 2:
            seen.add("removed")
            assert set(found.strokes) < set(WHOLE.strokes)
        elif size == 4:
            seen.add("moved")
            assert sorted(found.strokes) == sorted(WHOLE.strokes)
        else:
            seen.add("inserted")
            assert size == 6
            assert [s for s in found.strokes if s in WHOLE.strokes] == [1, 2, 3, 4]
    assert seen == {"moved", "inserted", "removed"}


def test_what_is_a_single_turn_is_not_taken_away():
    for seed in range(20):
        assert len(WHOLE.hopped(4, np.random.default_rng(seed)).strokes) == 8


def test_a_guess_follows_the_piece_of_the_path_that_is_asked_for(monkeypatch):
    """From a quarter to three quarters of the way, in as many segments."""
    asked, given = [], []
    monkeypatch.setattr(optimise, "Search", lambda *parts: given.append(parts))

    def plan(extended, path, segments, execution):
        asked.append((path(0.0), path(0.5), path(1.0), segments))
        return SimpleNamespace(flows="flows")

    monkeypatch.setattr(optimise, "plan", plan)
    way = line((0.0, 1.0), (4.0, 1.0))
    optimise.Optimiser(None, SimpleNamespace(), None, way, 9, execution=Execution())
    guess = given[0][3]
    assert guess(0.25, 0.75, 7) == "flows"
    ((begin, middle, end, segments),) = asked
    assert begin == pytest.approx([1.0, 1.0])
    assert middle == pytest.approx([2.0, 1.0])
    assert end == pytest.approx([3.0, 1.0])
    assert segments == 7
    optimise.Optimiser(None, SimpleNamespace(), None, way, 9)
    assert given[1][3] is None
