"""Words of a raised degree: every order is exact, and the nearest end is taken."""

import gc
from functools import cache

import numpy as np
import pytest
import sympy

from planner.execution.execution import ORDERS, Execution, nearest_words, uncollected
from planner.extension.extended import extend
from planner.lie.coordinates import exponential
from planner.lie.hall import hall_basis
from planner.lie.input_words import spellings
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import play, rollout
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem
from tests.planner.extension.test_rectangles import rescaled
from tests.systems import LIFTED, PAPER, hexapod


@pytest.mark.parametrize(("generators", "degree"), [(2, 2), (2, 5), (3, 3), (4, 2)])
@pytest.mark.parametrize("order", ["backward", "forward"])
@pytest.mark.parametrize("turned", [False, True])
def test_words_of_every_order_realise_the_same_coordinates(
    generators, degree, order, turned
):
    basis = hall_basis(generators, degree)
    h = np.random.default_rng(generators).uniform(-1, 1, (5, len(basis)))
    for wanted, (letters, times) in zip(
        h, spellings(basis, h, order, turned=turned), strict=True
    ):
        reached = np.zeros(len(basis))
        for generator, time in zip(letters, times, strict=True):
            reached = exponential(
                basis, time * np.eye(len(basis))[generator - 1], reached
            )
        assert reached == pytest.approx(wanted, abs=1e-9)


def test_turned_words_end_with_the_last_generator():
    basis = hall_basis(2, 2)
    ((letters, _),) = spellings(basis, np.array([[0.5, 0.5, 0.5]]))
    ((turned, _),) = spellings(basis, np.array([[0.5, 0.5, 0.5]]), turned=True)
    assert (letters[-1], turned[-1]) == (1, 2)


@pytest.mark.parametrize("goal", [[1, 1, 0], [-0.5, 0.7, 0.4], [0.5, -0.2, 0.7]])
def test_no_other_order_or_sign_ends_nearer(goal):
    system = hexapod()
    extended = extend(system, PAPER, degree=4)
    path = line(np.zeros(5), [*goal, 0, 0])
    steady = plan(extended, path, 1, execution=Execution(coordinates="backward"))
    h, nominal = steady.hall_coordinates, steady.nominal

    def miss(words):
        flows = [
            Flow(system.stratum_of[name], name, duration)
            for word in words
            for name, duration in zip(word.fields, word.durations, strict=True)
        ]
        return np.linalg.norm(play(system, flows, nominal[0])[-1] - nominal[-1])

    misses = [
        miss(extended.steering.scaled_words(h, order, np.array([first, second, 1, 1])))
        for order in ORDERS
        for first in (1, -1)
        for second in (1, -1)
    ]
    taken = plan(extended, path, 1)
    found = miss(nearest_words(extended, h, nominal))
    assert found == pytest.approx(min(misses), abs=1e-14)  # rounding of states near 1
    end = rollout(taken)[-1]
    assert np.linalg.norm(end - nominal[-1]) == pytest.approx(min(misses), rel=1e-6)
    assert max(misses) > 1.5 * min(misses)  # it matters which


@cache
def misses(degree, gains):
    """How far plans of 3 and of 20 segments end from a goal."""
    extended = extend(rescaled(hexapod(), gains), LIFTED, degree=degree)
    goal = [0.5, -0.2, 0.7, 0, 0]
    path = line(np.zeros(5), goal)
    ends = [rollout(plan(extended, path, segments))[-1] for segments in (3, 20)]
    return np.linalg.norm(np.subtract(ends, goal), axis=1)


@pytest.mark.parametrize("degree", [3, 4])
@pytest.mark.parametrize("gains", [(-1, 1), (1, -1), (-1, -1)])
def test_a_raised_degree_is_as_good_in_all_signs(degree, gains):
    coarse, fine = zip(misses(degree, gains), misses(degree, (1, 1)), strict=True)
    assert coarse[0] == pytest.approx(coarse[1], rel=1e-6)
    assert fine[0] == pytest.approx(fine[1], rel=0.02)


# [drive,[drive,turn]] and the like: elements of degree 3, their fields in all signs
CAR = ("drive", "turn", "[drive,turn]", "[drive,[drive,turn]]")


@pytest.mark.parametrize("signs", [(-1, 1), (1, -1), (-1, -1)])
@pytest.mark.parametrize("segments", [3, 24])
def test_elements_of_degree_3_are_as_good_in_all_signs(signs, segments):
    x, y, theta, phi = sympy.symbols("x y theta phi")
    state = (x, y, theta, phi)

    def miss(drive, turn):
        columns = {
            "drive": [drive * sympy.cos(theta), drive * sympy.sin(theta),
                      drive * sympy.tan(phi), 0],
            "turn": [0, 0, 0, turn],
        }  # fmt: skip
        extended = extend(StratifiedSystem(state, {"0": columns}, "0", {}), CAR)
        goal = [0.05, -0.1, 0.2, 0.1]  # printed words differ by 2.1 times in 3 segments
        end = rollout(plan(extended, line(np.zeros(4), goal), segments))[-1]
        return np.linalg.norm(end - goal)

    assert miss(*signs) == pytest.approx(miss(1, 1), rel=0.02)


def test_more_segments_of_a_raised_degree_still_converge():
    extended = extend(hexapod(), PAPER, degree=4)
    goal = [-0.5, 0.7, 0.4, 0, 0]
    misses = [
        np.linalg.norm(rollout(plan(extended, line(np.zeros(5), goal), n))[-1] - goal)
        for n in (1, 8)
    ]
    assert misses[1] < misses[0] / 8 < 4e-3  # 2.4e-2 and 5.2e-4 measured


@pytest.mark.parametrize("degree", [3, 4])
def test_ties_of_mirrored_words_do_not_depend_on_units(degree):
    """Alike segments have words that miss alike; rounding must not choose between them.

    In turn the two make up for what each of them misses.
    """
    misses = []
    for unit in (1e-3, 1.0, 10.0, 1e3):
        drive = [f"{unit}*cos(a)", f"{unit}*sin(a)", 0]
        fields = {"drive": drive, "turn": [0, 0, 1]}
        system = StratifiedSystem("x y a", {"0": fields}, "0")
        extended = extend(system, ["drive", "turn", "[drive,turn]"])
        found = plan(extended, line((0, 0, 0), (0, 1, 0)), 4, degree=degree)
        misses.append(np.linalg.norm(rollout(found)[-1] - (0, 1, 0)))
    assert misses == pytest.approx([misses[0]] * 4, rel=1e-6)
    assert misses[0] < {3: 0.055, 4: 0.006}[degree]  # 0.057, 0.012 with either alone


def test_garbage_is_collected_again_after_an_error():
    with pytest.raises(KeyError), uncollected():
        raise KeyError
    assert gc.isenabled()


def test_a_collector_that_is_off_stays_off():
    gc.disable()
    try:
        with uncollected():
            assert not gc.isenabled()
        assert not gc.isenabled()
    finally:
        gc.enable()
