"""Solutions are cut at a place on the path, and joined again."""

import numpy as np
import pytest

from planner.optimisation.task import Solution

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
