"""Nilpotent systems, given by hand, are steered to their goals exactly."""

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import numpy as np
import pytest

from planner.lie.coordinates import backward
from planner.lie.hall import degree, hall_basis
from planner.lie.input_words import word
from planner.numerics.arrays import Array
from tests.systems import hall_elements

ORDERS = ["backward", "forward"]


@dataclass(frozen=True)
class Nilpotent:
    """A nilpotent system by hand: brackets as columns, generators as exact flows.

    Attributes:
        elements: Names of the elements that span, in Hall order.
        columns: Configuration to the matrix of their vector fields.
        flows: For each generator the configuration after a time.
    """

    elements: tuple[str, ...]
    columns: Callable[[Array], Array]
    flows: tuple[Callable[[Array, float], Array], ...]


def heisenberg():
    """Rates x' = u1, y' = u2, z' = x u2."""
    return Nilpotent(
        ("1", "2", "[1,2]"),
        lambda x: np.array([[1, 0, 0], [0, 1, 0], [0, x[0], 1]]),
        (
            lambda x, t: x + [t, 0, 0],
            lambda x, t: x + [0, t, x[0] * t],
        ),
    )


def brockett():
    """Rates x_i' = u_i and z_ij' = x_i u_j - x_j u_i, for three inputs."""
    pairs = [(0, 1), (0, 2), (1, 2)]

    def field(x, i):
        area = [x[a] * (i == b) - x[b] * (i == a) for a, b in pairs]
        return np.array([*np.eye(3)[i], *area])

    def columns(x):
        brackets = np.vstack([np.zeros((3, 3)), 2 * np.eye(3)])
        return np.column_stack([*(field(x, i) for i in range(3)), brackets])

    flows = tuple(lambda x, t, i=i: x + t * field(x, i) for i in range(3))
    return Nilpotent(("1", "2", "3", "[1,2]", "[1,3]", "[2,3]"), columns, flows)


def chained(dimension):
    """Rates x1' = u1, x2' = u2, x3' = x2 u1, x4' = x3 u1, ...; a car with trailers."""
    names = ["2"]
    while len(names) < dimension - 1:
        names.append(f"[1,{names[-1]}]")

    def columns(x):
        matrix = np.diag([1.0, 1.0, *((-1.0) ** np.arange(1, dimension - 1))])
        matrix[2:, 0] = x[1:-1]
        return matrix

    def first(x, t):
        powers = [t**k / factorial(k) for k in range(dimension - 1)]
        return np.array([x[0] + t, *np.convolve(x[1:], powers)[: dimension - 1]])

    return Nilpotent(
        ("1", *names),
        columns,
        (first, lambda x, t: x + t * np.eye(dimension)[1]),
    )


def engel():
    """Rates x1' = u1, x2' = u2, x3' = x1 u2, x4' = x1^2/2 u2."""
    return Nilpotent(
        ("1", "2", "[1,2]", "[1,[1,2]]"),
        lambda x: np.array(
            [[1, 0, 0, 0], [0, 1, 0, 0], [0, x[0], 1, 0], [0, x[0] ** 2 / 2, x[0], 1]]
        ),
        (
            lambda x, t: x + [t, 0, 0, 0],
            lambda x, t: x + [0, t, x[0] * t, x[0] ** 2 / 2 * t],
        ),
    )


def cartan():
    """Rates as Engel's and x5' = x1 x2 u2: every bracket of degree 3 counts."""
    return Nilpotent(
        ("1", "2", "[1,2]", "[1,[1,2]]", "[2,[1,2]]"),
        lambda x: np.array(
            [
                [1, 0, 0, 0, 0],
                [0, 1, 0, 0, 0],
                [0, x[0], 1, 0, 0],
                [0, x[0] ** 2 / 2, x[0], 1, 0],
                [0, x[0] * x[1], x[1], 0, 1],
            ]
        ),
        (
            lambda x, t: x + [t, 0, 0, 0, 0],
            lambda x, t: (
                x
                + t * np.array([0, 1, x[0], x[0] ** 2 / 2, x[0] * x[1]])
                + [0, 0, 0, 0, x[0] * t**2 / 2]
            ),
        ),
    )


SYSTEMS = {
    "Heisenberg": heisenberg(),
    "Brockett": brockett(),
    "chained, 4 states": chained(4),
    "chained, 6 states": chained(6),
    "Engel": engel(),
    "Cartan": cartan(),
}


def steer(system, basis, start, goal, **options):
    """The end of the word that a straight line from start to goal asks for, eq. (5)."""
    place = [basis.index(e) for e in hall_elements(system.elements)]

    def inputs(t):
        v = np.zeros(len(basis))
        line = start + t * (goal - start)
        v[place] = np.linalg.solve(system.columns(line), goal - start)
        return v

    letters = word(basis, backward(basis, inputs), **options)
    x = start
    for generator, duration in letters:
        x = system.flows[generator - 1](x, duration)
    return x, letters


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_nilpotent_systems_are_steered_exactly(system, order):
    rng = np.random.default_rng(7)
    generators = sum(name.isdigit() for name in system.elements)
    basis = hall_basis(generators, degree(hall_elements(system.elements)[-1]))
    start, goal = rng.uniform(-1, 1, (2, len(system.elements)))
    end, _ = steer(system, basis, start, goal, order=order)
    assert end == pytest.approx(goal, abs=1e-9)


@pytest.mark.parametrize("order", ORDERS)
def test_elements_that_vanish_need_no_flow(order):
    system, basis = chained(5), hall_basis(2, 4)
    vanishing = {e for e in basis if str(e) not in system.elements}
    start, goal = np.random.default_rng(8).uniform(-1, 1, (2, 5))
    _, everything = steer(system, basis, start, goal, order=order)
    end, fewer = steer(system, basis, start, goal, order=order, vanishing=vanishing)
    assert end == pytest.approx(goal, abs=1e-9)
    assert len(fewer) < len(everything)


@pytest.mark.parametrize("order", ORDERS)
def test_a_basis_without_what_vanishes_steers_as_well(order):
    system = chained(5)
    basis = hall_elements(system.elements)
    start, goal = np.random.default_rng(9).uniform(-1, 1, (2, 5))
    end, _ = steer(system, basis, start, goal, order=order)
    assert end == pytest.approx(goal, abs=1e-9)
