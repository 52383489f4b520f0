"""The free Lie algebra by its theorems, in exact numbers wherever that is possible."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from planner.lie.free_lie import LieAlgebra, lie_algebra, structure_constants
from planner.lie.hall import Bracket, degree, hall_basis
from planner.lie.tensor import Tensor
from tests.systems import hall_elements

BASES = [hall_basis(2, 6), hall_basis(3, 4), hall_basis(4, 3)]
CHAINED = hall_elements(["1", "2", "[1,2]", "[1,[1,2]]", "[1,[1,[1,2]]]"])

few = settings(max_examples=25, deadline=None)  # exact numbers are slow


def numbers(basis):
    """Vectors of small fractions over a basis."""
    fraction = st.fractions(-2, 2, max_denominator=6)
    entries = st.lists(fraction, min_size=len(basis), max_size=len(basis))
    return entries.map(lambda values: np.array(values, dtype=object))


def unit(basis, text):
    """A Hall element as a vector of fractions."""
    return np.array([Fraction(str(e) == text) for e in basis], dtype=object)


def equal(a, b):
    return all((x == y).all() for x, y in zip(a.levels, b.levels, strict=True))


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_brackets_of_hall_elements_keep_the_degree_and_are_antisymmetric(basis):
    for a, b in product(basis, repeat=2):
        expansion = structure_constants(a, b)
        assert all(degree(e) == degree(a) + degree(b) for e in expansion)
        opposite = structure_constants(b, a)
        assert expansion == {e: -c for e, c in opposite.items()}


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_jacobis_identity_holds_for_all_hall_elements(basis):
    algebra = lie_algebra(basis)
    units = np.eye(len(basis), dtype=int)
    x, y, z = units[:, None, None], units[:, None], units
    xyz = algebra.bracket(x, algebra.bracket(y, z))
    yzx = algebra.bracket(y, algebra.bracket(z, x))
    zxy = algebra.bracket(z, algebra.bracket(x, y))
    assert xyz.any()
    assert not (xyz + yzx + zxy).any()


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_brackets_are_commutators_in_the_tensor_algebra(basis):
    algebra = lie_algebra(basis)
    for a, b in product(np.eye(len(basis), dtype=int), repeat=2):
        x, y = algebra.expand(a), algebra.expand(b)
        commutator = x * y + (y * x).divided_by(-1)
        assert equal(algebra.expand(algebra.bracket(a, b)), commutator)


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_elements_are_collected_from_their_words(basis):
    algebra = lie_algebra(basis)
    units = np.eye(len(basis), dtype=int)
    assert (algebra.collect(algebra.expand(units)) == units).all()


def test_campbell_baker_hausdorff_has_the_terms_of_eq_3():
    basis = hall_basis(2, 3)
    c = lie_algebra(basis).campbell_baker_hausdorff(unit(basis, "1"), unit(basis, "2"))
    half, twelfth = Fraction(1, 2), Fraction(1, 12)
    assert dict(zip(map(str, basis), c, strict=True)) == {
        "1": 1,
        "2": 1,
        "[1,2]": half,
        "[1,[1,2]]": twelfth,
        "[2,[1,2]]": -twelfth,
    }


@few
@given(st.data())
def test_campbell_baker_hausdorff_is_a_group(data):
    basis = hall_basis(2, 4)
    join = lie_algebra(basis).campbell_baker_hausdorff
    a, b, c = (data.draw(numbers(basis)) for _ in range(3))
    assert (join(join(a, b), c) == join(a, join(b, c))).all()
    assert not join(a, -a).any()


@few
@given(st.data())
def test_logarithm_undoes_exponential(data):
    basis = hall_basis(2, 4)
    x = lie_algebra(basis).expand(data.draw(numbers(basis)))
    assert equal(x.exp().log(), x)


@few
@given(st.data())
def test_logarithm_of_a_word_is_a_lie_element(data):
    basis = hall_basis(3, 3)
    algebra = lie_algebra(basis)
    a, b, c = (algebra.expand(data.draw(numbers(basis))).exp() for _ in range(3))
    log = (a * b * c).log()
    assert equal(algebra.expand(algebra.collect(log)), log)


def test_products_are_in_time_order():
    first, then = (
        Tensor(tuple(np.array(level, dtype=float) for level in levels))
        for levels in ([[0], [1, 0], [0] * 4], [[0], [0, 1], [0] * 4])
    )
    words = ["11", "12", "21", "22"]
    assert words[int((first * then).levels[2].argmax())] == "12"


@few
@given(st.data())
def test_elements_that_vanish_change_nothing_else(data):
    full = lie_algebra(hall_basis(2, 4))
    chained = lie_algebra(CHAINED)
    kept = [full.index[e] for e in CHAINED]
    a, b = data.draw(numbers(full.basis)), data.draw(numbers(full.basis))
    for name in ("bracket", "campbell_baker_hausdorff"):
        whole = getattr(full, name)(a, b)[kept]
        assert (getattr(chained, name)(a[kept], b[kept]) == whole).all()


def test_a_basis_that_lacks_an_element_of_its_brackets_is_refused():
    basis = hall_elements(["1", "2", "[1,[1,2]]"])
    message = r"has \[1,\[1,2\]\] but not \[1,2\], .*; add \[1,2\], or leave out"
    with pytest.raises(ValueError, match=message):
        LieAlgebra(basis)


@pytest.mark.parametrize("basis", [(2, 1), (1, 2, Bracket(2, 1)), (1, 1)])
def test_a_basis_out_of_order_or_not_of_hall_elements_is_refused(basis):
    with pytest.raises(
        ValueError, match="is not a part of the Hall basis in its order"
    ):
        LieAlgebra(basis)


@pytest.mark.parametrize("kind", ["complex", "M8[D]", "m8[s]", "U3"])
def test_coordinates_are_real_numbers(kind):
    """NumPy would turn dates and texts into floats, and leave imaginary parts out."""
    algebra = lie_algebra(hall_basis(2, 2))
    with pytest.raises(ValueError, match="coordinates are of type .*; give real num"):
        algebra.vector(np.zeros(3).astype(kind))
    assert (algebra.vector([Fraction(1, 2), 1, 0]) == [0.5, 1, 0]).all()


def test_an_empty_basis_is_refused():
    with pytest.raises(
        ValueError, match=r"empty; take hall_basis\(generators, max_deg"
    ):
        LieAlgebra(())


def test_a_basis_without_generators_is_refused():
    with pytest.raises(
        ValueError, match="is not a part of the Hall basis in its order"
    ):
        LieAlgebra((Bracket(1, 2),))


def test_exponentials_and_logarithms_refuse_other_constant_terms():
    basis = hall_basis(2, 2)
    x = lie_algebra(basis).expand(np.ones(len(basis)))
    with pytest.raises(
        ValueError, match="exp of a series with constant term 1.0; make"
    ):
        x.unit.exp()
    with pytest.raises(
        ValueError, match="log of a series with constant term 0.0; make"
    ):
        x.log()
