"""Optimised plans of systems without a body keep to what the path prescribes."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from models import shipped_system
from planner import Flow, rollout
from planner.optimisation import CHEAP, FLOW_SAMPLES, deviation
from sim import cli
from sim.errors import UsageError
from sim.problems import system as library
from sim.problems.system import SystemProblem

ROUNDED = 1.0 + 1e-6  # between the points at which it is looked at
ALONG = np.linspace(0.0, 1.0, 1001)


def problem(name, free=(), segments=4):
    given = replace(shipped_system(name), segments=segments)
    return SystemProblem(given, objective="time", free=free)


@cache
def solved(name):
    """A problem and its solution, found once."""
    asked = problem(name)
    return asked, asked.solve()


def apart(asked, plan, coordinate):
    """Farthest from the path in a coordinate, beside the point nearest in place."""
    found = rollout(plan, FLOW_SAMPLES)
    groups = [(0, 1), (coordinate,)]
    return deviation(found, asked.path.at(ALONG), groups)[1]


@pytest.mark.parametrize(("name", "coordinate"), [("unicycle", 2), ("car", 3)])
def test_what_the_path_prescribes_stays_as_near_as_in_the_stratified_plan(
    name, coordinate
):
    """Also angles that a field moves alone at a constant rate."""
    pytest.importorskip("casadi")
    asked, found = solved(name)
    assert found.fallback is None
    own = apart(asked, asked.stratified, coordinate)
    assert apart(asked, found.plan, coordinate) <= own * ROUNDED


def test_a_coordinate_that_is_freed_departs_farther_and_saves_time():
    pytest.importorskip("casadi")
    (held, found), freed = solved("unicycle"), problem("unicycle", free=("theta",))
    plans = found.plan, freed.solve().plan
    assert apart(held, plans[1], 2) > 2 * apart(held, plans[0], 2)
    assert freed.worth(plans[1]) < 0.8 * held.worth(plans[0])


def test_legs_are_free_by_themselves():
    """Yaw is not, although every field of the biped turns at a constant rate."""
    held = {t.coordinates: t.most for t in problem("biped")._tolerances()}
    assert {(0, 1), (2,)} <= held.keys()
    assert not {(3,), (4,)} & held.keys()
    assert np.isfinite(held[2,])
    freed = problem("biped", free=("theta",))._tolerances()
    assert {t.coordinates: t.most for t in freed}[2,] == np.inf


def test_only_legs_in_the_air_swing_cheaply_and_only_where_strokes_count():
    given = shipped_system("paper-hexapod")
    price = SystemProblem(given, objective="strokes", free=())._task.price
    assert {name for name, cost in price.items() if cost == CHEAP} == {"g1_2", "g2_1"}
    assert {name for name, cost in price.items() if cost == 1.0} >= {"g12_1", "g12_2"}
    times = SystemProblem(given, objective="time", free=())._task.price
    assert set(times.values()) == {1.0}
    car = SystemProblem(shipped_system("car"), objective="strokes", free=())
    assert set(car._task.price.values()) == {1.0}  # its wheels stay on the floor


def test_an_unknown_coordinate_cannot_be_freed():
    with pytest.raises(UsageError, match=r"'thta': --free; there are x, y, theta$"):
        problem("unicycle", free=("thta",))


def test_a_coordinate_is_freed_for_an_optimised_plan_only(capsys):
    assert cli.main(["plan", "unicycle", "--free", "theta"]) == 2
    assert "nothing to optimise: --free; give --optimise" in capsys.readouterr().err


def plan_between(start, goal, **parts):
    system = shipped_system("unicycle").system
    return SimpleNamespace(system=system, start=start, goal=goal, **parts)


def test_what_is_missed_is_a_share_of_the_way_and_nothing_where_there_is_none(
    monkeypatch,
):
    start, goal = np.array([2.0, 3.0, 0.0]), np.array([2.0, 7.0, 0.0])
    monkeypatch.setattr(library, "rollout", lambda _: np.array([start, [2, 6.0, 0]]))
    asked = problem("unicycle")
    assert asked.miss(plan_between(start, goal)) == pytest.approx(1 / 4)
    assert asked.miss(plan_between(start, start)) == 0.0


def test_a_part_of_the_line_ends_that_far_on_the_way_from_its_start(monkeypatch):
    asked = problem("unicycle")
    names = [str(symbol) for symbol in asked.problem.system.state]
    start = dict(zip(names, (2.0, 3.0, 0.5), strict=True))
    goal = dict(zip(names, (6.0, 1.0, 0.5), strict=True))
    given, tried = replace(asked.problem, start=start, goal=goal), []
    asked = SystemProblem(given, objective="time")

    def miss(nearer):
        tried.append(nearer.problem.states)
        return 0.0

    monkeypatch.setattr(SystemProblem, "stratified", property(lambda own: own))
    monkeypatch.setattr(SystemProblem, "miss", lambda own, _: miss(own))
    assert asked.attempt(0.25) == 0.0
    assert tried[0][0] == pytest.approx([2, 3, 0.5])
    assert tried[0][1] == pytest.approx([3, 2.5, 0.5])


def test_of_as_many_switches_the_shorter_plan_is_better():
    asked = SystemProblem(shipped_system("biped"), objective="switches")
    name = next(iter(asked.problem.system.fields))

    def worth(switches, seconds):
        flows = [Flow("1", name, seconds / 2), Flow("1", name, -seconds / 2)]
        return asked.worth(SimpleNamespace(contact_switches=switches, flows=flows))

    found = [worth(4, 1.0), worth(4, 20.0), worth(5, 1.0)]
    assert found == sorted(set(found))
    assert np.subtract(found, [4, 4, 5]) == pytest.approx(0, abs=1e-3)


def test_the_least_tolerance_is_of_the_path_s_size_wherever_it_begins(monkeypatch):
    """A plan without any deviation may depart by a hundredth of the way."""
    kept = []
    for begin in (0.0, 50.0):
        given = shipped_system("unicycle")
        names = [str(symbol) for symbol in given.system.state]
        start = dict(zip(names, (begin, -begin, 0.0), strict=True))
        goal = dict(zip(names, (begin + 4.0, 1.0 - begin, 0.0), strict=True))
        asked = SystemProblem(replace(given, start=start, goal=goal), objective="time")
        along = asked.path.at(ALONG)
        monkeypatch.setattr(SystemProblem, "stratified", None)
        monkeypatch.setattr(library, "rollout", lambda *_, along=along: along)
        kept.append([tolerance.most for tolerance in asked._tolerances()])
    assert kept[0] == pytest.approx([0.04, 0.04])
    assert kept[1] == pytest.approx(kept[0])
