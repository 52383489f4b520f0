"""Hall coordinates of formal flows: eqs. (6) to (9).

A flow S has backward coordinates h and forward coordinates f,

    S = e^(h_s B_s) ... e^(h_1 B_1) = e^(f_1 B_1) ... e^(f_s B_s),    eq. (6)

in time order: B_s runs first on the left, B_1 on the right. S itself is never formed.
Words of generators that realise the coordinates are made in `lie.input_words`.

A basis is a Hall basis, or the part of one that remains when the elements of an ideal
vanish (`lie.free_lie.LieAlgebra`).
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from sympy.polys.rings import ring

from planner.errors import ConvergenceError, message
from planner.lie.free_lie import LieAlgebra, lie_algebra
from planner.lie.hall import Element
from planner.numerics.arrays import Array
from planner.numerics.collocation import collocation

PIECES = 16  # of unit time at first; their nodes are at most 1/300 apart
EVALUATIONS = 100_000  # of inputs before they are refused; a jump needs 2 000
Number = Any  # float, array over many segments, or polynomial
Terms = dict[int, Number]  # a sum of elements: coefficients by index in the basis


def coordinate_rates(
    algebra: LieAlgebra, terms: Terms, coordinate: Callable[[int, Number], Number]
) -> Terms:
    """Rates h' for which S^-1 S' is the given sum of terms, eq. (7).

    S^-1 S' = sum_j Ad(e^(-h_1 B_1) ... e^(-h_(j-1) B_(j-1))) B_j h_j', so h_1' is the
    coefficient of B_1. Ad(e^(h_1 B_1)) of the other terms is the same sum without B_1.

    Terms are coefficients by index, of any type that can be added and multiplied;
    `coordinate` gives h_j from its index and rate, None for zero.

    Example:
        >>> from planner import LieAlgebra, coordinate_rates, hall_basis
        >>> algebra = LieAlgebra(hall_basis(2, 2))
        >>> h = [0.5, 0.5, 0.0]
        >>> coordinate_rates(algebra, {0: 1.0, 1: 1.0}, lambda j, rate: h[j])
        {0: 1.0, 1: 1.0, 2: 0.5}
    """
    rates, terms = {}, dict(terms)
    for j, structure in enumerate(algebra.structure):
        rate = terms.pop(j, None)
        h = coordinate(j, rate)
        if rate is not None:
            rates[j] = rate
        if h is not None:
            terms = adjoint_action(structure, h, terms)
    return rates


def adjoint_action(
    structure: Mapping[int, Mapping[int, int]], h: Number, terms: Terms
) -> Terms:
    """Ad(e^(h B)) of a sum of terms, e^(h B) (sum) e^(-h B), eq. (8).

    Eq. (8) has Ad(e^(-h B)), which gives the sum from the rates. This is its inverse,
    which recovers the rates from the sum.

    The structure constants of B are the coefficients of [B, B_j] for each j, and terms
    are coefficients by index.

    Example:
        >>> from planner import LieAlgebra, adjoint_action, hall_basis
        >>> algebra = LieAlgebra(hall_basis(2, 2))
        >>> adjoint_action(algebra.structure[0], 0.5, {1: 1.0})
        {1: 1.0, 2: 0.5}
    """
    total, power, n = dict(terms), terms, 0
    while power:
        n, before, power = n + 1, power, {}
        for j in structure.keys() & before.keys():
            for k, c in structure[j].items():
                term = before[j] * h * c / n
                power[k] = power[k] + term if k in power else term
        for k, term in power.items():
            total[k] = total[k] + term if k in total else term
    return total


def backward_matrix(basis: Sequence[Element]) -> sp.Matrix:
    """The matrix A(h) of eq. (9) over the symbols h1, ..., hs, polynomials in them.

    Example:
        >>> from planner import backward_matrix, hall_basis
        >>> backward_matrix(hall_basis(2, 2))
        Matrix([
        [1,  0, 0],
        [0,  1, 0],
        [0, h1, 1]])
    """
    algebra = lie_algebra(tuple(basis))
    size = len(algebra.basis)
    _, *h = ring([f"h{j + 1}" for j in range(size)], sp.QQ)
    matrix = sp.zeros(size, size)
    for column in range(size):
        rates = coordinate_rates(algebra, {column: h[0].ring.one}, lambda j, _: h[j])
        for row, rate in rates.items():
            matrix[row, column] = rate.as_expr()
    return matrix


def integrate(
    basis: Sequence[Element], inputs: ArrayLike, start: Array | None = None
) -> Array:
    """Backward coordinates that inputs reach in unit time, eq. (9).

    The result is exact if the inputs and the rates of the coordinates are polynomials
    of lower degree than there are nodes. Inputs that are zero throughout are skipped.

    Inputs v at the nodes of `collocation(nodes)` have shape (..., nodes, s), and the
    coordinates (..., s), at time zero too, where they are zero if not given.

    Raises:
        ValueError: The inputs are not finite or misshapen.

    Example:
        >>> from planner import hall_basis, integrate
        >>> integrate(hall_basis(2, 2), [[1, 0, 0], [0, 1, 0]])
        array([0.5 , 0.5 , 0.25])
    """
    algebra = lie_algebra(tuple(basis))
    inputs = algebra.vector(inputs, "inputs")
    if inputs.ndim < 2:
        raise ValueError(message("no_nodes", shape=inputs.shape))
    integral = collocation(inputs.shape[-2]).integral.T
    h = np.zeros((*inputs.shape[:-2], len(algebra.basis)))
    if start is not None:
        h += start

    def advance(j: int, rate: Array | None) -> Array | None:
        before = h[..., j, None]
        if rate is None:
            return before if before.any() else None
        path = before + rate @ integral
        h[..., j] = path[..., -1]
        return path

    every = ((j, inputs[..., j]) for j in range(inputs.shape[-1]))
    with np.errstate(over="ignore", invalid="ignore"):
        coordinate_rates(algebra, {j: v for j, v in every if v.any()}, advance)
    return algebra.vector(h)


def backward(
    basis: Sequence[Element], v: ArrayLike | Callable[[float], ArrayLike]
) -> Array:
    """Backward coordinates h(1) that inputs reach in unit time, eq. (9), shape (s,).

    Inputs v of shape (s,) are constant, or a function of time in [0, 1] with at most a
    few jumps. A pulse that is shorter than 1/300 may be missed.

    Raises:
        ValueError: The inputs are not finite or misshapen.
        ConvergenceError: The inputs are not bounded, or jump too often.

    Example:
        >>> from planner import backward, hall_basis
        >>> backward(hall_basis(2, 2), [1, 1, 0])
        array([1. , 1. , 0.5])
    """
    algebra = lie_algebra(tuple(basis))
    if not callable(v):
        return exponential(basis, algebra.vector(v, "inputs"))

    evaluations = count(1)

    def inputs(t: float) -> Array:
        if next(evaluations) > EVALUATIONS:
            raise ConvergenceError(message("unsmooth", time=t, count=EVALUATIONS))
        return algebra.vector(v(t), f"inputs at {t:.6g}")

    h = np.zeros(len(algebra.basis))
    for piece in range(PIECES):
        h = _adapted(algebra, inputs, piece / PIECES, 1 / PIECES, h)
    return h


def _adapted(
    algebra: LieAlgebra,
    inputs: Callable[[float], Array],
    time: float,
    length: float,
    start: Array,
) -> Array:
    """Coordinates at the end of an interval, halved until the result converges."""

    def step(begin: float, length: float, h: Array) -> Array:
        nodes = begin + length * collocation(16).nodes
        values = np.array([inputs(t) for t in nodes.tolist()])
        return integrate(algebra.basis, length * values, h)

    middle, half = time + length / 2, length / 2
    second = step(middle, half, step(time, half, start))
    change = np.abs(second - step(time, length, start)).max()
    if change <= 1e-12 * (1.0 + np.abs(second).max()):
        return second
    if length < 1e-14:  # bounded inputs move nothing within it
        facts = {"time": time, "change": change, "length": length}
        raise ConvergenceError(message("unbounded", **facts))
    first = _adapted(algebra, inputs, time, half, start)
    return _adapted(algebra, inputs, middle, half, first)


def forward(basis: Sequence[Element], h: ArrayLike) -> Array:
    """Forward coordinates f from backward ones h, eq. (6), both of shape (..., s).

    The backward coordinates of S^-1 = e^(-f_s B_s) ... e^(-f_1 B_1) are -f.

    Example:
        >>> from planner import forward, hall_basis
        >>> forward(hall_basis(2, 2), [1, 1, 0.5])
        array([ 1. ,  1. , -0.5])
    """
    return -exponential(basis, -logarithm(basis, h))


def backward_from_forward(basis: Sequence[Element], f: ArrayLike) -> Array:
    """Backward coordinates of a flow from its forward coordinates, shape (..., s).

    Example:
        >>> from planner import backward_from_forward, hall_basis
        >>> backward_from_forward(hall_basis(2, 2), [1, 1, -0.5])
        array([1. , 1. , 0.5])
    """
    return -forward(basis, -np.asarray(f))


def exponential(
    basis: Sequence[Element], a: ArrayLike, start: Array | None = None
) -> Array:
    """Backward coordinates of S e^(a_1 B_1 + ... + a_s B_s), shape (..., s).

    S is given by its backward coordinates `start`; S = 1 if not given.
    """
    algebra = lie_algebra(tuple(basis))
    a = algebra.vector(a)
    nodes = max(2, algebra.max_degree)  # the coordinates' rates have a lower degree
    constant = np.broadcast_to(a[..., None, :], (*a.shape[:-1], nodes, a.shape[-1]))
    return integrate(basis, constant, start)


def logarithm(basis: Sequence[Element], h: ArrayLike) -> Array:
    """Coordinates a of the first kind from backward coordinates, shape (..., s).

    Example:
        >>> from planner import hall_basis, logarithm
        >>> logarithm(hall_basis(2, 2), [1, 1, 0.5])
        array([1., 1., 0.])
    """
    algebra = lie_algebra(tuple(basis))
    a = h = algebra.vector(h)
    for _ in range(1, algebra.max_degree):  # each makes one more degree exact
        a = a + h - exponential(basis, a)
    return a
