"""The free nilpotent Lie algebra in its Hall basis: brackets, and products by eq. (3).

Elements are vectors of coefficients over a Hall basis, shape (..., s). Brackets of
higher degree than the basis has are zero. A basis may also lack elements that span an
ideal, such as brackets that vanish as fields; then these are zero as well.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations, product

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import message
from planner.lie.hall import Bracket, Element, degree, hall_basis, is_hall_pair, place
from planner.lie.tensor import Tensor
from planner.numerics.arrays import Array, reals

Expansion = Mapping[Element, int]


@cache
def structure_constants(a: Element, b: Element) -> Expansion:
    """The bracket [a, b] of two Hall elements, written in the Hall basis."""
    if a == b:
        return {}
    if place(a) > place(b):
        return {e: -c for e, c in structure_constants(b, a).items()}
    if not isinstance(b, Bracket) or is_hall_pair(a, b):
        return {Bracket(a, b): 1}
    # Jacobi: [a, [c, d]] = [[a, c], d] + [c, [a, d]], where a comes before c.
    total: dict[Element, int] = {}
    for e, c in structure_constants(a, b.left).items():
        _add(total, c, structure_constants(e, b.right))
    for e, c in structure_constants(a, b.right).items():
        _add(total, c, structure_constants(b.left, e))
    return total


def _add(total: dict[Element, int], factor: int, terms: Expansion) -> None:
    for element, c in terms.items():
        total[element] = total.get(element, 0) + factor * c
        if not total[element]:
            del total[element]


@dataclass(frozen=True, eq=False)
class LieAlgebra:
    """The nilpotent Lie algebra spanned by a basis of Hall elements.

    Attributes:
        basis: Hall elements in their order, s of them. The elements that it lacks up to
            its highest degree span an ideal.

    Raises:
        ValueError: The basis is empty, is not in the order of the Hall basis, or lacks
            elements that span no ideal.

    Example:
        >>> import numpy as np
        >>> from planner import LieAlgebra, hall_basis
        >>> algebra = LieAlgebra(hall_basis(2, 2))
        >>> algebra.campbell_baker_hausdorff(np.array([1, 0, 0]), np.array([0, 1, 0]))
        array([1. , 1. , 0.5])
    """

    basis: tuple[Element, ...]

    def __post_init__(self) -> None:
        if not self.basis:
            raise ValueError(message("empty"))
        here = set(self.basis)
        if [e for e in self._free_basis if e in here] != list(self.basis):
            raise ValueError(message("no_part", basis=", ".join(map(str, self.basis))))
        inner = (e for e in self._free_basis if degree(e) < self.max_degree)
        lacking = [e for e in inner if e not in here]
        for lost, generator in product(lacking, range(1, self.generators + 1)):
            for kept in here & structure_constants(generator, lost).keys():
                raise ValueError(message("lacks", kept=kept, lost=lost))

    @cached_property
    def degrees(self) -> tuple[int, ...]:
        """The degree of each element."""
        return tuple(map(degree, self.basis))

    @property
    def max_degree(self) -> int:
        """The degree beyond which brackets are zero."""
        return self.degrees[-1]

    @cached_property
    def generators(self) -> int:
        """Number m of generators, the highest that occurs."""
        return max((e for e in self.basis if isinstance(e, int)), default=1)

    @cached_property
    def index(self) -> Mapping[Element, int]:
        """The place of each element in the basis."""
        return {element: j for j, element in enumerate(self.basis)}

    @property
    def _free_basis(self) -> tuple[Element, ...]:
        return hall_basis(self.generators, self.max_degree)

    @cached_property
    def structure(self) -> tuple[Mapping[int, Mapping[int, int]], ...]:
        """Structure constants: `structure[i][j][k]` is that of B_k in [B_i, B_j].

        Indices count from 0, and zeros are left out.
        """
        table: list[dict[int, dict[int, int]]] = [{} for _ in self.basis]
        for i, j in combinations(range(len(self.basis)), 2):
            if self.degrees[i] + self.degrees[j] > self.max_degree:
                continue
            expansion = structure_constants(self.basis[i], self.basis[j])
            row = {self.index[e]: c for e, c in expansion.items() if e in self.index}
            if row:
                table[i][j] = row
                table[j][i] = {k: -c for k, c in row.items()}
        return tuple(table)

    def vector(self, values: ArrayLike, what: str = "coordinates") -> Array:
        """Values, one for each element along the last axis, as floats, shape (..., s).

        Raises `ValueError`, with the name of the values, if they are not finite or
        misshapen.
        """
        array = reals(values, what)  # a copy: callers may fill theirs again
        if array.shape[-1:] != (len(self.basis),):
            facts = {"what": what, "shape": array.shape, "size": len(self.basis)}
            raise ValueError(message("misshapen", **facts))
        if not np.isfinite(array).all():
            raise ValueError(f"{what} are not finite: {array.tolist()}")
        return array

    def bracket(self, a: Array, b: Array) -> Array:
        """The bracket [a, b] of coefficient vectors, shape (..., s)."""
        result = a * b * 0  # zeros of the same type of number
        for i, row in enumerate(self.structure):
            for j, terms in row.items():
                for k, c in terms.items():
                    result[..., k] += c * (a[..., i] * b[..., j])
        return result

    def campbell_baker_hausdorff(self, a: Array, b: Array) -> Array:
        """The element c with e^a e^b = e^c, eq. (3), shape (..., s)."""
        return self.collect((self.expand(a).exp() * self.expand(b).exp()).log())

    def expand(self, a: Array) -> Tensor:
        """The element as a tensor: brackets become commutators."""
        levels = [a[..., :1] * 0]
        for layer, commutators in zip(self._layers, self._commutators, strict=True):
            levels.append(a[..., layer] @ commutators)
        return Tensor(tuple(levels))

    def collect(self, tensor: Tensor) -> Array:
        """The coefficients of a Lie element that is given as a tensor, shape (..., s).

        Every word is replaced by its bracket [w1, [w2, ...]], which multiplies a Lie
        element of degree n by n (the theorem of Dynkin, Specht and Wever).
        """
        pairs = zip(tensor.levels[1:], self._word_brackets, strict=True)
        layers = [level @ brackets / n for n, (level, brackets) in enumerate(pairs, 1)]
        return np.concatenate(layers, axis=-1)

    @cached_property
    def _layers(self) -> tuple[Array, ...]:
        """Indices of the elements of each degree."""
        degrees = np.array(self.degrees)
        return tuple(np.flatnonzero(degrees == n + 1) for n in range(self.max_degree))

    @cached_property
    def _commutators(self) -> tuple[Array, ...]:
        """The elements of each degree n as sums of words, shape (elements, m**n)."""
        rows = [_commutator(element, self.generators) for element in self.basis]
        return tuple(
            np.array([rows[j] for j in layer], dtype=int).reshape(len(layer), -1)
            for layer in self._layers
        )

    @cached_property
    def _word_brackets(self) -> tuple[Array, ...]:
        """The brackets of words of each length n, shape (m**n, elements)."""
        names = range(1, self.generators + 1)
        first = np.array([[e == name for e in self.basis] for name in names], dtype=int)
        every = [first]
        for _ in range(1, self.max_degree):
            every.append(np.concatenate([self.bracket(g, every[-1]) for g in first]))
        pairs = zip(every, self._layers, strict=True)
        return tuple(brackets[:, layer] for brackets, layer in pairs)


@cache
def _commutator(element: Element, generators: int) -> Array:
    """Coefficients of an element's words, shape (generators**degree,)."""
    if not isinstance(element, Bracket):
        return np.eye(generators, dtype=int)[element - 1]
    a = _commutator(element.left, generators)
    b = _commutator(element.right, generators)
    return np.kron(a, b) - np.kron(b, a)


@cache
def lie_algebra(basis: tuple[Element, ...]) -> LieAlgebra:
    """The Lie algebra that a basis spans; prepared once for each basis."""
    return LieAlgebra(basis)
