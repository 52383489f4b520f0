"""Optimised plans of systems without a body keep to what the path prescribes."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models import shipped_system
from planner import rollout
from planner.optimisation import CHEAP, deviation
from sim import cli
from sim.errors import UsageError
from sim.problems.system import FLOW_SAMPLES, SystemProblem

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
