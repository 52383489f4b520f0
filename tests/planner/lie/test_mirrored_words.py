"""Mirrored words reach the same coordinates; what they miss has the other sign."""

import numpy as np
import pytest

from planner.lie.coordinates import exponential, logarithm
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import hall_basis
from planner.lie.input_words import spellings
from planner.lie.mirrored_words import mirrored_spellings


def missed(basis, spelling):
    """Logarithm of a word in a basis of higher degree."""
    coordinates = np.zeros(len(basis))
    for generator, duration in zip(*spelling, strict=True):
        step = duration * np.eye(len(basis))[generator - 1]
        coordinates = exponential(basis, step, coordinates)
    return logarithm(basis, coordinates)


@pytest.mark.parametrize("bracket_degree", [2, 3])
@pytest.mark.parametrize("degree", [2, 3, 4])
def test_mirrored_words_reach_the_same_coordinates(bracket_degree, degree):
    basis = hall_basis(2, degree)
    h = np.random.default_rng(degree).uniform(-1, 1, (3, len(basis)))
    for row, spelling in zip(
        h, mirrored_spellings(basis, h, bracket_degree), strict=True
    ):
        reached = missed(basis, spelling)
        assert reached == pytest.approx(logarithm(basis, row), abs=1e-12)  # rounding


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_what_words_of_one_bracket_miss_changes_its_sign(degree):
    basis, longer = hall_basis(2, degree), hall_basis(2, degree + 1)
    degrees = np.array(lie_algebra(longer).degrees)
    h = np.zeros((1, len(basis)))
    h[0, -1] = -0.7  # of degree k
    (plain,) = spellings(basis, h)
    (mirror,) = mirrored_spellings(basis, h, degree)
    beyond = degrees == degree + 1
    found = missed(longer, plain), missed(longer, mirror)
    assert np.abs(found[0][beyond]).max() > 0.01
    assert found[1][beyond] == pytest.approx(-found[0][beyond], abs=1e-12)  # rounding
