"""The Hall basis: its size, its order, its completeness, its names."""

from itertools import product

import pytest
from sympy import divisors, mobius

from planner.lie.hall import Bracket, degree, hall_basis

SMALL = [(1, 4), (2, 6), (3, 5), (4, 4), (11, 2)]


def witt(generators, n):
    """The dimension of degree n of the free Lie algebra (Witt's formula)."""
    return sum(mobius(d) * generators ** (n // d) for d in divisors(n)) // n


@pytest.mark.parametrize("generators", [1, 2, 3, 4])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 5])
def test_size_of_each_degree_is_given_by_witts_formula(generators, n):
    basis = hall_basis(generators, 5)
    assert sum(degree(e) == n for e in basis) == witt(generators, n)


def test_generators_count_from_one_and_come_first():
    assert hall_basis(3, 2)[:3] == (1, 2, 3)


def test_one_generator_has_no_brackets_up_to_any_degree():
    assert hall_basis(1, 10**30) == (1,)


@pytest.mark.parametrize(
    ("generators", "max_degree"), [(2, 24), (2, 10**30), (10**30, 1), (10**30, 10**30)]
)
def test_bases_without_end_are_refused_at_once(generators, max_degree):
    with pytest.raises(ValueError, match="have more than 1,000,000 Hall elements"):
        hall_basis(generators, max_degree)


@pytest.mark.parametrize(("generators", "max_degree"), SMALL)
def test_order_is_by_degree_then_left_then_right_element(generators, max_degree):
    basis = hall_basis(generators, max_degree)
    brackets = [e for e in basis if isinstance(e, Bracket)]
    keys = [(degree(e), basis.index(e.left), basis.index(e.right)) for e in brackets]
    assert keys == sorted(keys)


@pytest.mark.parametrize(("generators", "max_degree"), SMALL)
def test_exactly_the_brackets_that_meet_the_condition_are_in_the_basis(
    generators, max_degree
):
    basis = hall_basis(generators, max_degree)
    place = {e: i for i, e in enumerate(basis)}
    for a, b in product(basis, repeat=2):
        if degree(a) + degree(b) > max_degree:
            continue
        inner_left = place[b.left] if isinstance(b, Bracket) else -1
        condition = inner_left <= place[a] < place[b]
        assert (Bracket(a, b) in place) == condition


def test_a_lower_degree_gives_a_part_of_the_same_basis():
    low, high = hall_basis(3, 3), hall_basis(3, 5)
    assert high[: len(low)] == low


def test_elements_are_written_without_spaces():
    assert [str(e) for e in hall_basis(2, 3)] == [
        "1",
        "2",
        "[1,2]",
        "[1,[1,2]]",
        "[2,[1,2]]",
    ]


def test_a_basis_without_generators_or_degrees_is_refused():
    with pytest.raises(
        ValueError, match="generators is 0; a Lie algebra needs at least"
    ):
        hall_basis(0, 2)
    with pytest.raises(ValueError, match="max_degree is 0; generators have degree 1"):
        hall_basis(2, 0)
