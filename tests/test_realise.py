"""Words end where their Hall coordinates say: formally, on systems, and by RoughPy."""

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.coordinates import backward, backward_from_forward, logarithm
from planner.fields import Array
from planner.free_lie import lie_algebra
from planner.hall import degree, hall_basis, parse
from planner.realise import word, words

BASES = [hall_basis(2, 2), hall_basis(4, 2), hall_basis(2, 4), hall_basis(3, 3)]
ORDERS = ["backward", "forward"]
ROUNDING = (
    1e-10  # measured: below 1e-12 for coordinates up to 2, in hundreds of letters
)

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
        together = words(basis, h, order)
        alone = [word(basis, each, order) for each in h]
        assert list(map(len, together)) == list(map(len, alone))
        for a, b in zip(together, alone, strict=True):
            assert np.array(a) == pytest.approx(np.array(b))


def test_coordinates_of_another_shape_are_refused():
    with pytest.raises(ValueError, match=r"of shape \(2,\) do not fit .*; give 3"):
        word(hall_basis(2, 2), [1.0, 2.0])


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
    place = [basis.index(parse(name)) for name in system.elements]

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
    basis = hall_basis(generators, degree(parse(system.elements[-1])))
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
    basis = tuple(map(parse, system.elements))
    start, goal = np.random.default_rng(9).uniform(-1, 1, (2, 5))
    end, _ = steer(system, basis, start, goal, order=order)
    assert end == pytest.approx(goal, abs=1e-9)
