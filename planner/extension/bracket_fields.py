"""Hall elements as vector fields: the brackets of a system's fields.

Brackets that vanish as fields are left out where the algebra allows it. Brackets with a
field that commutes with all others are not even formed.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from planner.errors import message
from planner.lie.free_lie import structure_constants
from planner.lie.hall import Bracket, Element, free_dimension, hall_basis
from planner.systems.elements import relabel
from planner.systems.fields import Symbols, VectorField, lie_bracket
from planner.systems.rounding import vanishing
from planner.systems.strata import StratifiedSystem


@dataclass(frozen=True, eq=False)
class HallFields:
    """Hall basis over fields of a system, with the vector field of each element."""

    generators: tuple[str, ...]  # in the order in which the basis numbers them
    elements: tuple[Element, ...]  # but for an ideal that vanishes as fields
    names: tuple[str, ...]  # of the elements
    fields: tuple[VectorField, ...]  # of the elements
    vanishing: frozenset[Element]  # as fields, with brackets that do not vanish
    clashing: frozenset[frozenset[str]]  # pairs of generators that do not commute
    entangled: tuple[int, ...]  # numbers, from 1, of the generators in such pairs

    @property
    def only_pair(self) -> tuple[int, int] | None:
        """Numbers of two generators with the only bracket; None if there are others."""
        match self.elements[len(self.generators) :]:
            case (Bracket(left=int() as first, right=int() as second),):
                return first, second
        return None

    def commute(self, a: str, b: str) -> bool:
        """Whether the flows of two generators may be interchanged."""
        return frozenset((a, b)) not in self.clashing


def hall_fields(
    system: StratifiedSystem,
    generators: Sequence[str],
    max_degree: int,
    most: int | None = None,
) -> HallFields:
    """The Hall basis up to a degree over some of a system's fields, named once each.

    `ValueError` says that there would be more elements than `most`.

    Example:
        >>> from planner import EXAMPLES, hall_fields
        >>> hall_fields(EXAMPLES["heisenberg"], ["f", "g"], max_degree=3).names
        ('f', 'g', '[f,g]')
    """
    own, state = [system.fields[name] for name in generators], system.state
    brackets = [lie_bracket(f, g, state) for f, g in combinations(own, 2)]
    pairs = zip(combinations(generators, 2), vanishing(brackets, state), strict=True)
    clashing = frozenset(frozenset(pair) for pair, zero in pairs if not zero)
    clash = frozenset().union(*clashing)
    numbers = tuple(i for i, g in enumerate(generators, start=1) if g in clash)
    count = len(numbers)
    degree = max_degree if count > 1 else 1  # a single field has no brackets
    if most is not None and (degree > most or free_dimension(count, degree) > most):
        raise ValueError(message("brackets", degree=max_degree, count=count, most=most))
    beyond = hall_basis(count, degree)[count:] if numbers else ()
    full: list[Element] = [*range(1, len(generators) + 1)]
    full += [renumbered(element, numbers) for element in beyond]
    fields = fields_of(full, own, state)
    zeros = vanishing(list(fields.values()), state)
    zero = frozenset(e for e, gone in zip(full, zeros, strict=True) if gone)
    ideal = _largest_ideal(zero, full, len(generators))
    elements = tuple(e for e in full if e not in ideal)
    names = tuple(str(renumbered(e, generators)) for e in elements)
    known = tuple(generators), elements, names, tuple(fields[e] for e in elements)
    return HallFields(*known, zero - ideal, clashing, entangled=numbers)


def renumbered(element: Element, generators: Sequence[Any]) -> Any:
    """The same element over other generators: their numbers, or the names of fields."""
    return relabel(element, lambda number: generators[number - 1])


def fields_of(
    elements: Iterable[Element], generators: Sequence[VectorField], state: Symbols
) -> dict[Element, VectorField]:
    """Fields of elements and generators; elements within others come before them."""
    fields: dict[Element, VectorField] = dict(enumerate(generators, start=1))
    for element in elements:
        if isinstance(element, Bracket):
            left, right = fields[element.left], fields[element.right]
            fields[element] = lie_bracket(left, right, state)
    return fields


def _largest_ideal(
    zero: frozenset[Element], elements: Sequence[Element], generators: int
) -> frozenset[Element]:
    """The elements among those that vanish whose brackets are all among them, too."""
    kept, ideal = set(elements) - zero, zero
    while needed := {
        lost
        for lost in ideal
        for generator in range(1, generators + 1)
        if kept & structure_constants(generator, lost).keys()
    }:
        ideal -= needed
        kept |= needed
    return ideal
