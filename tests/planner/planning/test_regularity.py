"""Between nodes: paths through singular configurations are refused, others are not."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import PlannerError, ResolutionError
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.systems.strata import StratifiedSystem
from tests.systems import X, Y, heisenberg

ELEMENTS = ["g1", "g2", "[g1,g2]"]


def along(speed, start, goal, segments, nodes=None):
    """A plan of x' = speed(x) u beside y' = w."""
    system = StratifiedSystem((X, Y), {"0": {"a": [speed, 0], "b": [0, 1]}}, "0")
    return plan(system, line([start, 0], [goal, 1]), segments, ["a", "b"], nodes=nodes)


@pytest.mark.parametrize("segments", [1, 2, 7, 40])
@pytest.mark.parametrize(
    ("speed", "start", "goal"),
    [(sp.cos(X), 0, 3), (X, -1.03, 1), (X**2, -1.03, 1), (1 / X, -1.03, 1)],
    ids=["pole", "zero", "double zero", "singular field"],
)
def test_paths_through_singular_configurations_are_refused(
    speed, start, goal, segments
):
    place = np.pi / 2 if speed.has(sp.cos) else 0
    with pytest.raises(PlannerError, match=r"between \(.*lose rank or are sing") as no:
        along(speed, start, goal, segments)
    before, after = (float(end.split(",")[0]) for end in str(no.value).split("(")[1:3])
    assert before < place < after


@pytest.mark.parametrize("segments", [1, 2, 5, 20])
def test_paths_that_only_come_near_are_planned(segments):
    end = rollout(along(X, 0.05, 1, segments))[-1]
    # the polynomial through the nodes follows 1 / x to a hundredth at most
    assert end == pytest.approx([1, 1], rel=0.02)


@pytest.mark.parametrize("segments", [1, 3, 40])
def test_rounding_of_coordinates_that_stand_still_is_no_miss(segments):
    # x is 4 throughout, and its derivative rounding that no polynomial follows
    fields = {"a": [1, 0, 0], "b": [0, 1, sp.log(X - 3)]}
    system = StratifiedSystem((X, Y, sp.Symbol("z")), {"0": fields}, "0")
    path = line([4, 0, 0], [4, 1, 0])
    end = rollout(plan(system, path, segments, ["a", "b", "[a,b]"]))[-1]
    assert end == pytest.approx([4, 1, 0], abs=1e-12)


def test_corners_and_fast_turns_are_planned_where_nodes_resolve_them():
    def corner(s):
        return [s, abs(s - 0.37), 0]

    def turns(s):
        return [np.cos(120 * np.pi * s), np.sin(120 * np.pi * s), 0]

    assert plan(heisenberg(), corner, 3, ELEMENTS).flows
    assert plan(heisenberg(), turns, 200, ELEMENTS).flows
    with pytest.raises(
        ResolutionError, match="too fast.*plan more segments"
    ) as refused:
        plan(heisenberg(), turns, 5, ELEMENTS)
    assert refused.value.segments == (0, 1, 2, 3, 4)  # twelve turns each
