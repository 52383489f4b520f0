"""Plans in the order of a gait, and with feet lifted at their ends."""

from dataclasses import replace
from itertools import chain, pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.errors import StratumError
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.archive import load_plan, save_plan
from planner.planning.lifted_ends import _joined, _lift, plan_between, stratum_at
from planner.planning.rollouts import rollout
from planner.systems.flows import Flow, gait_steps
from tests.systems import GAIT, LIFTED, hexapod

REVERSED = GAIT[::-1]


def walk(planned):
    """All strata of a plan in a gait in turn, on which nothing flows included."""
    ends = planned.depart, planned.arrive
    steps = gait_steps(planned.system, planned.flows, planned.gait, ends)
    return [ends[0], *chain(*steps)]


@pytest.fixture(scope="module")
def walker():
    return extend(hexapod(heights=True), LIFTED)


@pytest.mark.parametrize("stance", ["paper", "centred"])
@pytest.mark.parametrize("gait", [GAIT, REVERSED])
def test_strata_are_visited_in_the_order_of_the_gait(walker, gait, stance):
    execution = Execution(gait=gait, stance=stance)
    path = shipped_system("paper-hexapod").path
    planned = plan(walker, path, 8, execution=execution)
    around = list(zip(gait, gait[1:], strict=False))
    visited = walk(planned)
    assert (visited[0], visited[-1]) == ("12", "12")
    assert set(pairwise(visited)) <= set(around)
    singles = [stratum for stratum in visited if stratum != "12"]
    assert all(a != b for a, b in pairwise(singles))  # tripods alternate
    assert planned.contact_switches == len(visited) - 1  # each step moves one tripod
    free = plan(walker, path, 8, execution=replace(execution, gait=()))
    assert planned.contact_switches >= free.contact_switches


def test_gait_changes_the_order_and_not_where_the_body_goes(walker):
    path = shipped_system("paper-hexapod").path
    plans = [
        plan(walker, path, 8, execution=Execution(coordinates="backward", gait=gait))
        for gait in ((), GAIT)
    ]
    ends = [rollout(planned)[-1] for planned in plans]
    assert ends[0] == pytest.approx(ends[1], abs=1e-12)


def test_crawl_lifts_its_feet_in_the_order_asked_for():
    problem = shipped_system("quadruped-crawl")
    extended = extend(problem.system, problem.elements)
    steps_of = ("234", "124", "134", "123")
    gait = ("1234", *(s for step in steps_of for s in (step, "1234")))
    planned = plan(extended, problem.path, 4, execution=Execution(gait=gait))
    lifted = [stratum for stratum in walk(planned) if stratum != "1234"]
    cycle = {a: b for a, b in zip(steps_of, steps_of[1:] + steps_of[:1], strict=True)}
    assert all(cycle[a] == b for a, b in pairwise(lifted))


def test_gait_that_lacks_a_stratum_is_refused(walker):
    path = shipped_system("paper-hexapod").path
    with pytest.raises(StratumError, match="does not visit S2, which is needed"):
        plan(walker, path, 1, execution=Execution(gait=("12", "1", "12")))
    with pytest.raises(StratumError, match="does not close"):
        plan(walker, path, 1, execution=Execution(gait=("12", "1")))


def test_gait_is_kept_with_the_plan(walker, tmp_path):
    path = shipped_system("paper-hexapod").path
    planned = plan(walker, path, 1, execution=Execution(gait=GAIT))
    save_plan(planned, tmp_path / "plan.json")
    again = load_plan(tmp_path / "plan.json")
    assert (again.gait, walk(again)) == (planned.gait, walk(planned))


@pytest.mark.parametrize("segments", [1, 3])
@pytest.mark.parametrize(
    ("before", "after", "strata"),
    [
        ((0.0, 0.2), (0.1, 0.0), ("1", "2")),
        ((0.1, 0.0), (0.1, 0.0), ("2", "2")),
        ((0.0, 0.0), (0.0, 0.3), ("12", "1")),
        ((0.0, 0.0), (0.0, 0.0), ("12", "12")),
    ],
)
def test_feet_may_be_lifted_at_either_end(walker, segments, before, after, strata):
    start = np.array([0, 0, 0, 0, 0, *before], dtype=float)
    goal = np.array([0.2, 0.1, 0.1, 0, 0, *after])
    planned = plan_between(walker, start, goal, segments)
    assert (planned.depart, planned.arrive) == strata
    end = rollout(planned)[-1]
    assert end[5:] == pytest.approx(after, abs=1e-15)
    down = [np.array([*x[:5], 0, 0]) for x in (start, goal)]
    same = rollout(plan_between(walker, *down, segments))[-1]
    assert end[:3] == pytest.approx(same[:3], abs=1e-2)  # other words, as accurate
    assert len(planned.segment_ends) == segments


def test_lifted_feet_come_down_before_another_stratum_is_visited(walker):
    start = np.array([0, 0, 0, 0, 0, 0, 0.2])
    planned = plan_between(walker, start, [0.2, 0, 0, 0, 0, 0, 0], 2)
    states = rollout(planned)
    for flow, x in zip(planned.flows, states[1:], strict=True):
        if "2" in flow.stratum:
            assert x[6] == pytest.approx(0.0, abs=1e-15)


def test_feet_below_the_ground_are_refused(walker):
    start, goal = np.zeros(7), [0.2, 0, 0, 0, 0, 0, -0.1]
    with pytest.raises(
        StratumError, match=r"height_2 is -0\.1, a foot below the ground"
    ):
        plan_between(walker, start, goal, 1)


def test_strata_of_configurations():
    system = hexapod(heights=True)
    at = [0.0] * 5
    assert stratum_at(system, [*at, 0, 0]) == "12"
    assert stratum_at(system, [*at, 0, 0.1]) == "1"
    with pytest.raises(StratumError, match="lies on no stratum"):
        stratum_at(system, [*at, 0.1, 0.1])


def test_a_foot_is_lifted_by_its_height_however_fast_its_field_lifts_it(walker):
    shape = SimpleNamespace(
        system=SimpleNamespace(strata={"1": ["both", "up"]}),
        rates={"both": np.array([1.0, 4.0]), "up": np.array([0.0, 4.0])},
    )
    assert _lift(shape, "1", 1, 0.2) == Flow("1", "up", pytest.approx(0.05))


def test_every_segment_keeps_its_flows_where_feet_land_and_rise_in_between(walker):
    """Feet land after the first stay, and rise before the last, of two segments."""
    path = shipped_system("paper-hexapod").path
    one, two = (next(iter(walker.system.strata[stratum])) for stratum in "12")
    flows = [Flow("1", one, 0.1 + k) for k in range(2)]
    flows += [Flow("2", two, 0.3 + k) for k in range(3)]
    planned = replace(
        plan(walker, path, 3), flows=tuple(flows), segment_ends=(1, 3, 5),
        depart="1", arrive="2",
    )  # fmt: skip
    landing, lifting = [Flow("1", one, 9.0)], [Flow("2", two, 8.0), Flow("2", two, 7.0)]
    ends = planned.start, planned.goal
    joined = _joined(planned, landing, lifting, ends)
    assert joined.flows == (*flows[:2], *landing, *lifting, *flows[2:])
    own = [[f for f in part if f in flows] for part in joined.segments()]
    assert own == [flows[:1], flows[1:3], flows[3:]]


@pytest.mark.parametrize("ends", [(2, 3, 5), (1, 2, 5)])
def test_flows_that_land_end_the_segment_of_the_first_stay(walker, ends):
    """And those that rise begin the segment of the last stay, if it begins there."""
    path = shipped_system("paper-hexapod").path
    one, two = (next(iter(walker.system.strata[stratum])) for stratum in "12")
    flows = [Flow("1", one, 0.1 + k) for k in range(2)]
    flows += [Flow("2", two, 0.3 + k) for k in range(3)]
    given = {"flows": tuple(flows), "segment_ends": ends, "depart": "1", "arrive": "2"}
    planned = replace(plan(walker, path, 3), **given)
    land, rise = Flow("1", one, 9.0), Flow("2", two, 8.0)
    joined = _joined(planned, [land], [rise], (planned.start, planned.goal))
    number = ends.index(2)
    segments = [*joined.segments()]
    assert segments[number][-1] == land
    assert segments[number + 1][0] == rise
