"""Mirrored and shortest words reach their coordinates; mirrored ones miss otherwise."""

import numpy as np
import pytest

from planner.lie.coordinates import exponential, logarithm
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import hall_basis
from planner.lie.input_words import mirrored_spellings, short_durations, spellings, word


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


BASIS = hall_basis(2, 2)
RNG = np.random.default_rng(8)
SOME_ZERO = [[a, b, c] for a in (0, 0.3) for b in (0, -0.7) for c in (0, 0.2)]
COORDINATES = np.concatenate([SOME_ZERO, RNG.normal(size=(50, 3))])


def shortest(h):
    return short_durations(h[:, 0], h[:, 1], h[:, 2])


def test_shortest_words_reach_their_coordinates():
    reached = np.zeros_like(COORDINATES)
    for letter, durations in zip((0, 1, 0, 1, 0), shortest(COORDINATES).T, strict=True):
        flow = np.zeros_like(COORDINATES)
        flow[:, letter] = durations
        reached = exponential(BASIS, logarithm(BASIS, flow), reached)
    # a few roundings of numbers near one
    assert reached == pytest.approx(COORDINATES, abs=1e-13)


@pytest.mark.parametrize("order", ["backward", "forward"])
def test_shortest_words_are_not_longer_than_the_printed_ones(order):
    printed = [sum(abs(t) for _, t in word(BASIS, h, order)) for h in COORDINATES]
    assert (np.abs(shortest(COORDINATES)).sum(axis=1) <= np.add(printed, 1e-12)).all()


def test_no_other_rectangle_makes_a_shorter_word():
    p = np.concatenate([np.geomspace(1e-4, 20, 4000), -np.geomspace(1e-4, 20, 4000)])
    for (a, b, c), durations in zip(COORDINATES, shortest(COORDINATES), strict=True):
        second_first = _length(p, c / p, a, b)
        first_first = _length(p, (c - a * b) / p, -a, b)
        found = np.abs(durations).sum()
        assert found <= min(second_first.min(), first_first.min()) + 1e-12


def _length(p, q, width, height):
    return np.abs([p, p - width, q, q - height]).sum(axis=0)


@pytest.mark.parametrize("length", [2, 3, 4, 5, 6, 9])
def test_no_word_of_any_length_is_shorter(length):
    sizes = RNG.choice([0.05, 1.0, 3.0], (500, length))
    words = sizes * RNG.normal(size=(500, length))
    reached = np.zeros((len(words), 3))
    for k, durations in enumerate(words.T):
        flow = np.zeros_like(reached)
        flow[:, k % 2] = durations
        reached = exponential(BASIS, logarithm(BASIS, flow), reached)
    found = np.abs(shortest(reached)).sum(axis=1)
    # a few roundings of numbers near ten
    assert (found <= np.abs(words).sum(axis=1) + 1e-12).all()


def test_rounding_of_a_bracket_makes_no_rectangle():
    assert np.abs(shortest(np.array([[0.3, 0.2, 1e-17]]))).sum() == pytest.approx(0.5)
