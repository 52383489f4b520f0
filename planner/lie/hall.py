"""Philip Hall basis of the free Lie algebra, the elements B_1, B_2, ... of eq. (6).

Elements are formal expressions. A generator is its number, counted from 1 as in g_1,
..., g_m; every other element is a `Bracket` of two elements.

The conventions are those of Lafferriere and Sussmann, reference [3] of the paper:
    * Elements are ordered by degree, generators by number, brackets of one degree by
      their left and then by their right element.
    * [a, b] belongs to the basis if a comes before b and, if b is a bracket [c, d], c
      does not come after a.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any


@dataclass(frozen=True, slots=True)
class Bracket:
    """The formal Lie bracket [left, right] of two elements; written `[1,[1,2]]`."""

    left: "Element"
    right: "Element"

    def __str__(self) -> str:
        return f"[{self.left},{self.right}]"


Element = int | Bracket  # the number of a generator, or a bracket of elements

MOST_ELEMENTS, DEEPEST = 10**6, 60  # of a basis; a degree that always goes beyond


@cache
def hall_basis(generators: int, max_degree: int) -> tuple[Element, ...]:
    """The elements B_i of eq. (6): all Hall elements up to a degree, in order.

    `ValueError` refuses a number of generators, or a degree, below 1, and bases of more
    than a million elements.

    Example:
        >>> from planner import hall_basis
        >>> [str(element) for element in hall_basis(generators=2, max_degree=3)]
        ['1', '2', '[1,2]', '[1,[1,2]]', '[2,[1,2]]']
    """
    if generators < 1:
        raise ValueError(f"generators is {generators}; a Lie algebra needs at least 1")
    if max_degree < 1:
        raise ValueError(f"max_degree is {max_degree}; generators have degree 1")
    if generators == 1:  # whose brackets vanish
        return (1,)
    if free_dimension(generators, min(max_degree, DEEPEST)) > MOST_ELEMENTS:
        what = f"{generators} generators to degree {max_degree}, which have more than"
        raise ValueError(f"{what} {MOST_ELEMENTS:,} Hall elements; ask for less")
    layers: list[list[Element]] = [[*range(1, generators + 1)]]
    for total in range(2, max_degree + 1):
        found = [
            Bracket(left, right)
            for low in range(1, total // 2 + 1)
            for left, right in product(layers[low - 1], layers[total - low - 1])
            if is_hall_pair(left, right)
        ]
        layers.append(sorted(found, key=place))
    return tuple(element for layer in layers for element in layer)


def free_dimension(generators: int, max_degree: int) -> int:
    """The number of Hall elements up to a degree, by Witt's formula."""
    counts: list[int] = []
    for n in range(1, max_degree + 1):
        shorter = sum(d * counts[d - 1] for d in range(1, n) if n % d == 0)
        counts.append((generators**n - shorter) // n)
    return sum(counts)


def is_hall_pair(left: Element, right: Element) -> bool:
    """Whether the bracket of two Hall elements is itself a Hall element."""
    if place(left) >= place(right):
        return False
    return not isinstance(right, Bracket) or place(right.left) <= place(left)


@cache
def place(element: Element) -> tuple[Any, ...]:
    """A key by which elements sort in the order of the basis."""
    if isinstance(element, Bracket):
        return (degree(element), place(element.left), place(element.right))
    return (1, element)


@cache
def degree(element: Element) -> int:
    """Number of generators in an element, each counted as often as it occurs.

    Example:
        >>> from planner import degree, hall_basis
        >>> [degree(element) for element in hall_basis(2, 3)]
        [1, 1, 2, 3, 3]
    """
    if isinstance(element, Bracket):
        return degree(element.left) + degree(element.right)
    return 1
