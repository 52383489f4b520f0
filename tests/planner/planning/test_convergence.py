"""Orders of convergence: expected from the fields alone, then measured."""

from math import inf

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.convergence import convergence_order, faster
from planner.planning.paths import ellipse, line
from planner.planning.rollouts import rollout
from planner.systems.strata import StratifiedSystem
from tests.systems import PAPER, chained, hexapod

X, Y, Z = sp.symbols("x y z")


def generic(state, monomials):
    """Two fields with random polynomials as rates: no bracket of them vanishes."""
    rng = np.random.default_rng(4)

    def field(first):
        rates = [
            sum(float(c) * m for c, m in zip(row, monomials, strict=True))
            for row in rng.uniform(-0.2, 0.2, (len(state), len(monomials)))
        ]
        return [int(i == first) + rate for i, rate in enumerate(rates)]

    fields = {"f": field(0), "g": field(1)}
    return StratifiedSystem(state, {"0": fields}, "0")


def test_degrees_are_whole_numbers():
    walker = extend(hexapod(), PAPER)
    for wrong in (2.5, "3", True):
        with pytest.raises(ValueError, match=f"degree is {wrong!r}; a whole number"):
            walker.to_degree(wrong)


PLANE = generic((X, Y), [1, X, Y, X * Y])
SPACE = generic((X, Y, Z), [1, X, Y * Z])


def misses(extended, goal, segments, coordinates="backward"):
    """Distances from the goal for some numbers of segments."""
    goal = np.array(goal)
    path, execution = line(0 * goal, goal), Execution(coordinates=coordinates)
    plans = [plan(extended, path, n, execution=execution) for n in segments]
    return [np.linalg.norm(rollout(planned)[-1] - goal) for planned in plans]


def measured(extended, goal, segments, coordinates="backward"):
    """Power of 1/n by which the miss falls between two numbers of segments."""
    few, many = misses(extended, goal, segments, coordinates)
    return np.log(few / many) / np.log(segments[1] / segments[0])


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_without_brackets_the_order_is_the_degree(degree):
    extended = extend(PLANE, ["f", "g"], degree)
    expected = convergence_order(extended, line([0, 0], [0.4, 0.3]))
    assert (expected.order, expected.bracket_degree) == (degree, 1)
    order = measured(extended, [0.4, 0.3], (2, 4))
    assert order == pytest.approx(degree, abs=0.05)  # derived; higher terms remain


@pytest.mark.parametrize(
    ("degree", "coordinates", "order"),
    [
        (2, "backward", 1 / 2),
        (3, "backward", 1),
        (2, "symmetric", 1),
    ],
)
def test_of_a_bracket_the_order_is_half_of_what_the_degree_has_beyond(
    degree, coordinates, order
):
    extended = extend(SPACE, ["f", "g", "[f,g]"], degree)
    goal = [0.05, -0.03, 0.05]
    expected = convergence_order(extended, line(np.zeros(3), goal), coordinates)
    assert expected.order == order
    found = measured(extended, goal, (32, 64), coordinates)
    assert found == pytest.approx(order, abs=0.1)  # derived; higher terms remain


@pytest.mark.parametrize(
    ("name", "degree", "coordinates", "order"),
    [
        ("paper-hexapod", 2, "backward", 1),
        ("paper-hexapod", 4, "symmetric", 2),
        ("biped", 2, "backward", 1),
        ("biped", 4, "backward", 2),
        ("unicycle", 2, "backward", 1 / 2),
        ("unicycle", 2, "symmetric", 1),
        ("unicycle", 3, "backward", 1),
        ("unicycle", 4, "backward", 3 / 2),
        ("unicycle", 4, "symmetric", 2),
        ("car", 3, "backward", 2 / 3),
        ("car", 5, "backward", 4 / 3),
        ("hexapod-trailer", 3, "symmetric", 2 / 3),
    ],
)
def test_shipped_systems_converge_as_expected(name, degree, coordinates, order):
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements, degree)
    path = problem.path
    assert convergence_order(extended, path, coordinates).order == pytest.approx(order)
    ways = (32, 64) if degree < 5 else (16, 32)
    found = measured(extended, problem.states[1], ways, coordinates)
    assert found == pytest.approx(order, abs=0.1)  # derived; higher terms remain


@pytest.mark.parametrize("size", [3, 4, 5, 6])
def test_nilpotent_systems_are_exact_at_their_degree_and_beyond(size):
    names = ["g2"]
    while len(names) < size - 1:
        names.append(f"[g1,{names[-1]}]")
    goal = np.random.default_rng(size).uniform(-1, 1, size)
    for degree in (size - 1, size):
        extended = extend(chained(size), ["g1", *names], degree)
        expected = convergence_order(extended, line(np.zeros(size), goal))
        assert expected.order == inf
        assert misses(extended, goal, [1]) == pytest.approx([0], abs=1e-12)


@pytest.mark.parametrize("way", [1e-101, 1e-150, 1e-300])
def test_path_shorter_than_floats_can_multiply_is_none(way):
    """Its coordinates would be too small for products of three of them."""
    system = hexapod()
    still = line([0.0] * system.dimension, [way] + [0.0] * (system.dimension - 1))
    extended = extend(system, PAPER)
    assert convergence_order(extended, still).order == inf
    assert plan(extended, still, 2).flows == ()


def test_path_that_needs_no_bracket_converges_by_its_fields_alone():
    extended = extend(hexapod(), PAPER)
    expected = convergence_order(extended, line(np.zeros(5), [1, 0, 0, 0, 0]))
    assert expected.bracket_degree == 1
    assert expected.order >= 2


def test_path_that_turns_back_asks_for_the_brackets_that_it_needs():
    extended = extend(hexapod(), PAPER)
    loop = convergence_order(extended, ellipse(np.zeros(5), (1, 0.6)))
    assert (loop.bracket_degree, loop.order) == (2, 1)


def test_higher_degree_meets_the_reference_in_one_segment():
    paper = extend(hexapod(), PAPER)
    goal = [1, 1, 0, 0, 0]
    path = line(np.zeros(5), goal)
    printed, higher = plan(paper, path, 16), plan(paper, path, 1, degree=4)
    ends = [np.linalg.norm(rollout(p)[-1] - goal) for p in (printed, higher)]
    assert len(higher.flows) == 75 < len(printed.flows)
    assert ends[1] < 4.3e-4 < 2.6e-3 < ends[0]  # measured: 4.22e-4 and 2.7e-3
    assert plan(paper, path, 16, degree=2).flows == printed.flows


def test_what_is_offered_is_faster_and_keeps_its_word():
    problem = shipped_system("unicycle")
    extended = extend(problem.system, problem.elements)
    now = convergence_order(extended, problem.path)
    offers = faster(extended, problem.path, now)
    assert set(offers) == {"symmetric words", "degree 3"}
    assert all(offer.order == 1 > now.order for offer in offers.values())
    exact = extend(chained(3), ["g1", "g2", "[g1,g2]"])
    path = line(np.zeros(3), np.ones(3))
    assert faster(exact, path, convergence_order(exact, path)) == {}


def test_walkers_are_offered_a_degree_that_does_help():
    # degree 3 does not: its words are not their own mirror images
    walker, path = extend(hexapod(), PAPER), line(np.zeros(5), [1, 1, 0, 0, 0])
    offers = faster(walker, path, convergence_order(walker, path))
    assert {what: offer.order for what, offer in offers.items()} == {"degree 4": 2}


def test_redundant_elements_miss_less():
    path = line(np.zeros(5), [1, 1, 0, 0, 0])
    both = ("g1_1", "g2_2", *PAPER, "[g1_1,g2_2]")
    few, more = (
        np.linalg.norm(rollout(plan(extend(hexapod(), e), path, 16))[-1] - path(1.0))
        for e in (PAPER, both)
    )
    assert more < few


@pytest.mark.parametrize(
    ("degree", "message"),
    [
        (1, "degree is 1, but plans steer by brackets of degree 2; give at least 2"),
        (30, "over 2 fields that do not commute has more than 500 brackets"),
        (10**6, "over 2 fields that do not commute has more than 500 brackets"),
    ],
)
def test_degrees_that_cannot_be_are_refused(degree, message):
    with pytest.raises(ValueError, match=message):
        extend(hexapod(), PAPER, degree)
