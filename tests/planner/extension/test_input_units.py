"""Plans do not depend on the units and signs that a system is written in."""

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.execution.execution import Execution
from planner.extension.choice import choose_elements
from planner.extension.extended import extend
from planner.extension.steering import Steering
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.planning.shooting import aim, steer
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, hexapod

CAR = ("d", "s", "[d,s]", "[d,[d,s]]")


def unicycle():
    fields = {"d": ["cos(a)", "sin(a)", 0], "t": [0, 0, 1]}
    return StratifiedSystem("x y a", {"0": fields}, "0")


def car():
    fields = {"d": ["cos(a)", "sin(a)", "tan(b)", 0], "s": [0, 0, 0, 1]}
    return StratifiedSystem("x y a b", {"0": fields}, "0")


def rescaled(system, inputs=(), coordinates=()):
    """The same system with factors of inputs and of coordinates, by name."""
    inputs, coordinates = dict(inputs), dict(coordinates)
    units = {s: sp.nsimplify(coordinates.get(str(s), 1)) for s in system.state}
    back = {s: s / unit for s, unit in units.items()}
    strata = {
        stratum: {
            name: [
                sp.nsimplify(inputs.get(name, 1)) * unit * e.subs(back, simultaneous=1)
                for e, unit in zip(field, units.values(), strict=True)
            ]
            for name, field in fields.items()
        }
        for stratum, fields in system.strata.items()
    }
    level_sets = {
        stratum: [f.subs(back, simultaneous=True) for f in functions]
        for stratum, functions in system.level_sets.items()
    }
    metric = {
        str(s): weight / float(units[s])
        for s, weight in zip(system.state, system.weights, strict=True)
    }
    other = StratifiedSystem(system.state, strata, system.bottom, level_sets, metric)
    return other, np.array([float(unit) for unit in units.values()])


def end_of(system, factors, elements, goal, segments, degree=None, **order):
    """Where a plan from zero ends, in the units of the system before."""
    path = line(np.zeros(len(goal)), goal * factors)
    extended = extend(system, elements, degree)
    execution = Execution(**order)
    return rollout(plan(extended, path, segments, execution=execution))[-1] / factors


SYSTEMS = {
    "unicycle": (unicycle(), ("d", "t", "[d,t]"), [0.2, 0.7, -0.1], "d t", "x a"),
    "car": (car(), CAR, [0.05, -0.1, 0.2, 0.1], "d s", "y b"),
    "hexapod": (
        hexapod(**METRES), LIFTED, [0.1, 0.05, 0.3, 0, 0], "g1_1 g2_2", "y theta",
    ),
}  # fmt: skip


@pytest.mark.parametrize("degree", [2, 3, 4])
@pytest.mark.parametrize("name", SYSTEMS)
def test_no_plan_depends_on_units_or_signs(name, degree):
    system, elements, goal, inputs, coordinates = SYSTEMS[name]
    goal = np.array(goal)
    if name == "car" and degree == 2:
        degree = None
    plain = end_of(*rescaled(system), elements, goal, 2, degree)
    first, second = inputs.split()
    near, turned = coordinates.split()
    for factors in (
        ({first: 0.001}, {}),
        ({second: 1000}, {near: 1000}),
        ({first: -1}, {turned: 0.001}),
        ({first: -100, second: -0.01}, {near: 0.01, turned: 100}),
    ):
        end = end_of(*rescaled(system, *factors), elements, goal, 2, degree)
        # 1 % of the miss is asked for; what is left is rounding
        assert np.linalg.norm(end - plain) < 1e-4 * np.linalg.norm(plain - goal)


@pytest.mark.parametrize("words", ["backward", "forward", "shortest", "symmetric"])
def test_words_of_every_kind_are_spelled_in_the_same_units(words):
    system, elements, goal, *_ = SYSTEMS["unicycle"]
    goal = np.array(goal)
    plain = end_of(*rescaled(system), elements, goal, 3, coordinates=words)
    scaled = rescaled(system, {"d": -0.01, "t": 30}, {"x": 1000})
    end = end_of(*scaled, elements, goal, 3, coordinates=words)
    assert end == pytest.approx(plain, abs=1e-9)


def test_redundant_elements_are_weighed_by_the_same_units():
    problem = shipped_system("quadruped-crawl")
    goal = problem.states[1]
    plain = end_of(*rescaled(problem.system), problem.elements, goal, 2)
    scaled = rescaled(problem.system, {"g1234_1": 100, "g234_1": -0.01}, {"x": 1000})
    end = end_of(*scaled, problem.elements, goal, 2)
    assert np.linalg.norm(end - plain) < 1e-4 * np.linalg.norm(plain - goal)


def test_shots_and_aims_are_as_many_in_all_units():
    elements, there = ("d", "t", "[d,t]"), np.array([0.1, 1, 0])
    order = Execution(coordinates="backward")
    found = []
    for factors in (((), ()), ({"d": -0.02}, {"x": 1000, "y": 1000})):
        system, units = rescaled(unicycle(), *factors)
        extended, goal = extend(system, elements), there * units
        steered = steer(extended, np.zeros(3), goal, order)
        aimed = rollout(aim(extended, line(np.zeros(3), goal), 4, order))[-1]
        assert system.length(aimed - goal) < 4e-9
        found.append(steered.distances[:-1])
    assert found[0] == pytest.approx(found[1], rel=1e-3)


def test_a_field_that_vanishes_is_measured_by_its_surroundings_in_any_unit():
    fields = {"d": ["1/2 - 2*x", 0, "y"], "t": [0, 1, 0]}
    plain = StratifiedSystem("x y z", {"0": fields}, "0")
    found = []
    for unit in (1, 0.001, 1000):
        system, factors = rescaled(plain, coordinates={"x": unit})
        units = extend(system, ("d", "t", "[d,t]")).steering.rectangles.units
        at = factors * [[0.25, 0.0, 0.0]]
        assert not system.compiled("d").velocity(at[0]).any()
        found.append([*units.at(at)[0], *units.measured(np.ones((1, 3)), at)[1][0]])
    assert found[1] == pytest.approx(found[0])
    assert found[2] == pytest.approx(found[0])


def test_words_without_units_are_those_of_the_paper():
    system, _ = rescaled(hexapod(**METRES), {"g1_1": 100})
    scaled = extend(system, LIFTED).steering
    printed = Steering(scaled.hall, scaled.selected, scaled.degree, None)
    h = np.array([[0.1, 0.2, 0.0, 0.0, 0.25]])
    (word,) = printed.words(h, "backward", np.zeros((1, 5)))
    assert list(zip(word.fields, word.durations, strict=True)) == [
        ("g1_1", 0.5), ("g2_2", 0.5), ("g1_1", -0.5),
        ("g2_2", pytest.approx(-0.3)), ("g1_1", pytest.approx(0.1)),
    ]  # fmt: skip
    (other,) = scaled.words(h, "backward", np.zeros((1, 5)))
    assert other.durations[0] == pytest.approx(0.05)  # 100 times as fast, as far


@pytest.mark.parametrize("size", [1e-20, 1e-9])
def test_a_goal_however_near_is_moved_to(size):
    for words in ("fewest", "backward", "shortest", "symmetric"):
        goal = np.array([0, size, 0])
        execution = Execution(coordinates=words)
        planned = plan(unicycle(), line(np.zeros(3), goal), 1, execution=execution)
        assert np.linalg.norm(rollout(planned)[-1] - goal) < 1e-4 * size


def test_chosen_elements_may_be_given_as_they_are():
    choice = choose_elements(unicycle(), np.zeros(3))
    assert extend(unicycle(), choice).elements == choice.elements
