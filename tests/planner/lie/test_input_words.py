"""Words are the flows of their Hall coordinates: formally, and by RoughPy."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from planner.lie.coordinates import backward, backward_from_forward, logarithm
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import degree, hall_basis
from planner.lie.input_words import spellings, word

BASES = [hall_basis(2, 2), hall_basis(4, 2), hall_basis(2, 4), hall_basis(3, 3)]
ORDERS = ["backward", "forward"]
ROUNDING = 1e-10  # measured: below 1e-12 for coordinates up to 2

some = settings(max_examples=25, deadline=None)


def basis_and_coordinates():
    return st.sampled_from(BASES).flatmap(
        lambda basis: st.tuples(
            st.just(basis),
            st.lists(st.floats(-2, 2), min_size=len(basis), max_size=len(basis)),
        )
    )


def exponent(basis, letters):
    """The logarithm of a word, letter by letter in the tensor algebra."""
    algebra = lie_algebra(basis)
    total = algebra.expand(np.zeros(len(basis))).unit
    for generator, duration in letters:
        letter = duration * np.eye(len(basis))[algebra.index[generator]]
        total = total * algebra.expand(letter).exp()
    return algebra.collect(total.log())


@some
@given(basis_and_coordinates(), st.sampled_from(ORDERS))
def test_a_word_is_the_flow_of_its_coordinates(case, order):
    basis, h = case
    letters = word(basis, h, order)
    expected = logarithm(basis, h)
    # a dropped remainder of 1e-12 counts as rounding, too
    assert exponent(basis, letters) == pytest.approx(expected, abs=ROUNDING)


@some
@given(basis_and_coordinates(), st.sampled_from(ORDERS))
def test_no_generator_follows_itself(case, order):
    generators = [generator for generator, _ in word(*case, order)]
    assert all(a != b for a, b in zip(generators, generators[1:], strict=False))


def test_backward_words_run_brackets_first_and_forward_words_last():
    basis = hall_basis(2, 2)
    ahead = word(basis, backward_from_forward(basis, [0.1, 0.2, 0.09]), "forward")
    loop = [(1, 0.3), (2, 0.3), (1, -0.3), (2, -0.3)]
    assert np.array(ahead) == pytest.approx(np.array([(1, 0.1), (2, 0.2), *loop]))
    back = word(basis, [0.1, 0.2, 0.09])  # the loop's last letter joins the next one
    expected = np.array([*loop[:3], (2, -0.3 + 0.2), (1, 0.1)])
    assert np.array(back) == pytest.approx(expected)


@pytest.mark.parametrize("basis", BASES, ids=len)
def test_a_negative_bracket_is_the_word_of_the_positive_one_run_back(basis):
    for element, unit in zip(basis, np.eye(len(basis)), strict=True):
        if degree(element) == degree(basis[-1]):  # lower ones need corrections
            back = [(generator, -t) for generator, t in reversed(word(basis, unit))]
            assert word(basis, -unit) == back


def test_letters_that_cancel_disappear():
    # the loop 1 2 1' 2' of size 0.3 meets 2 and then 1 of the same size
    expected = np.array([(1, 0.3), (2, 0.3)])
    found = np.array(word(hall_basis(2, 2), [0.3, 0.3, 0.09]))
    assert found == pytest.approx(expected)


def test_rounding_noise_moves_nothing():
    assert word(hall_basis(2, 3), np.full(5, 9e-13)) == []


def test_words_of_many_segments_are_the_words_of_each():
    basis = hall_basis(3, 3)
    h = np.random.default_rng(5).uniform(-1, 1, (6, len(basis)))
    h[1], h[2, 3:6] = 0.0, 0.0
    for order in ORDERS:
        together = [
            list(zip(*found, strict=True)) for found in spellings(basis, h, order)
        ]
        alone = [word(basis, each, order) for each in h]
        assert list(map(len, together)) == list(map(len, alone))
        for a, b in zip(together, alone, strict=True):
            assert np.array(a) == pytest.approx(np.array(b))


def test_segments_whose_coordinates_have_the_same_signs_share_their_generators():
    h = np.array([[0.3, 0.2, 0.5], [0.1, 0.4, 0.7], [0.1, 0.4, -0.7]])
    (first, _), (second, _), (third, _) = spellings(hall_basis(2, 2), h)
    assert first is second
    assert first != third


def test_coordinates_of_another_shape_are_refused():
    with pytest.raises(ValueError, match=r"of shape \(2,\) do not fit .*; give 3"):
        word(hall_basis(2, 2), [1.0, 2.0])


@pytest.mark.parametrize(("make", "shape"), [(word, (2, 3)), (spellings, (3,))])
def test_one_segment_is_told_from_many(make, shape):
    with pytest.raises(ValueError, match=r"\) have \d axes, not \d; give `word` the c"):
        make(hall_basis(2, 2), np.ones(shape))


def test_other_orders_are_refused():
    with pytest.raises(ValueError, match="order is 'paper'; choose backward"):
        word(hall_basis(2, 2), [1.0, 2.0, 3.0], "paper")


@pytest.mark.parametrize("order", ORDERS)
def test_a_word_played_as_inputs_gives_its_coordinates_back(order):
    basis = hall_basis(2, 3)
    h = np.array([0.4, -0.3, 0.2, 0.1, -0.2])
    letters = word(basis, h, order)
    columns = np.zeros((len(letters), len(basis)))
    for column, (generator, duration) in zip(columns, letters, strict=True):
        column[generator - 1] = duration * len(letters)

    def inputs(t):
        return columns[min(int(t * len(letters)), len(letters) - 1)]

    # measured 2e-11: each jump has to be found
    assert backward(basis, inputs) == pytest.approx(h, abs=1e-9)


@pytest.mark.parametrize("generators", [2, 3])
def test_log_signature_of_the_word_agrees_with_roughpy(generators):
    reason = "has no wheel for this machine"
    roughpy = pytest.importorskip("roughpy", reason=reason, exc_type=ImportError)
    basis = hall_basis(generators, 4)
    h = np.random.default_rng(6).uniform(-1, 1, len(basis))
    letters = word(basis, h)
    steps = np.zeros((len(letters), generators))
    for step, (generator, duration) in zip(steps, letters, strict=True):
        step[generator - 1] = duration
    context = roughpy.get_context(generators, 4, roughpy.DPReal)
    path = roughpy.LieIncrementStream.from_increments(steps, ctx=context)
    found = path.log_signature(roughpy.RealInterval(0, len(steps)))
    expected = {str(e): a for e, a in zip(basis, logarithm(basis, h), strict=True)}
    signature = {str(item.key()): item.value().to_float() for item in found}
    assert signature == pytest.approx(expected, abs=ROUNDING)
