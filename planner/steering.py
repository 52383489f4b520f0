"""From fictitious inputs to Hall coordinates to words of real inputs, many at a time.

The Hall basis over an extended system's generators, less the brackets that vanish as
fields. Brackets outside the selected elements stay: they get coordinates too, h_ij' =
h_i v_j in degree 2, and must be realised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from planner.coordinates import integrate
from planner.elements import Tree, leaves, name_of, parse_names, relabel
from planner.fields import Array, Symbols, VectorField, lie_bracket, vanishing
from planner.free_lie import structure_constants
from planner.hall import Bracket, Element, hall_basis
from planner.realise import Order, words
from planner.strata import StratifiedSystem

Word = list[tuple[str, float]]


@dataclass(frozen=True, eq=False)
class Steering:
    """Hall coordinates over the generators of an extended system.

    Attributes:
        generators: Fields in order of first appearance among the elements.
        elements: Hall elements over them, less an ideal that vanishes as fields.
        basis: Their names.
        selected: Index in `basis` of each selected element.
        vanishing: Elements that are kept for their brackets but vanish as fields.
        clashing: Pairs of generators that do not commute.
    """

    generators: tuple[str, ...]
    elements: tuple[Element, ...]
    basis: tuple[str, ...]
    selected: tuple[int, ...]
    vanishing: frozenset[Element]
    clashing: frozenset[frozenset[str]]

    def commute(self, a: str, b: str) -> bool:
        """Whether the flows of two generators may be interchanged."""
        return frozenset((a, b)) not in self.clashing

    def hall_coordinates(self, inputs: Array) -> Array:
        """Backward Hall coordinates that inputs reach in unit time, eq. (9).

        Args:
            inputs: Fictitious inputs of the selected elements at collocation nodes,
                shape (segments, nodes, p).

        Returns:
            Shape (segments, s), in the order of `basis`.
        """
        everywhere = np.zeros((*inputs.shape[:-1], len(self.basis)))
        everywhere[..., list(self.selected)] = inputs
        return integrate(self.elements, everywhere)

    def words(self, hall_coordinates: Array, order: Order) -> list[Word]:
        """Flows of the generators that realise Hall coordinates, one word a segment.

        Args:
            hall_coordinates: Backward coordinates, shape (segments, s).
            order: `backward` runs brackets first, `forward` generators first.

        Returns:
            For each segment fields and signed durations in time order.
        """
        numbered = words(self.elements, hall_coordinates, order, self.vanishing)
        return [[(self.generators[i - 1], t) for i, t in one] for one in numbered]


def steering(system: StratifiedSystem, trees: Sequence[Tree]) -> Steering:
    """Prepare the Hall coordinates of selected elements.

    Args:
        system: System whose fields the elements are made of.
        trees: Elements over field names.

    Raises:
        ValueError: An element is not in the Hall basis over its generators.
    """
    generators = tuple(dict.fromkeys(leaf for tree in trees for leaf in leaves(tree)))
    clashing = _clashing(system, generators)
    highest = max(len(leaves(tree)) for tree in trees)
    full = _entangled_basis(generators, clashing, highest)
    zero = _vanishing(full, [system.fields[name] for name in generators], system.state)
    lost = _largest_ideal(zero, full, len(generators))
    elements = tuple(e for e in full if e not in lost)
    basis = tuple(name_of(_tree(e, generators)) for e in elements)
    selected = tuple(_index(tree, basis) for tree in trees)
    return Steering(generators, elements, basis, selected, zero - lost, clashing)


def _clashing(
    system: StratifiedSystem, names: Sequence[str]
) -> frozenset[frozenset[str]]:
    """Pairs of fields that do not commute."""
    pairs = list(combinations(names, 2))
    brackets = [
        lie_bracket(system.fields[a], system.fields[b], system.state) for a, b in pairs
    ]
    zeros = vanishing(brackets, system.state)
    return frozenset(
        frozenset(p) for p, zero in zip(pairs, zeros, strict=True) if not zero
    )


def _entangled_basis(
    generators: Sequence[str], clashing: frozenset[frozenset[str]], highest: int
) -> list[Element]:
    """All generators, and the brackets of those that do not commute with all others."""
    numbers = [
        i
        for i, g in enumerate(generators, start=1)
        if any(g in pair for pair in clashing)
    ]
    brackets = hall_basis(len(numbers), highest)[len(numbers) :] if numbers else ()
    return [
        *range(1, len(generators) + 1),
        *(_renumbered(e, numbers) for e in brackets),
    ]


def _renumbered(element: Element, numbers: Sequence[int]) -> Element:
    if isinstance(element, Bracket):
        return Bracket(
            _renumbered(element.left, numbers), _renumbered(element.right, numbers)
        )
    return numbers[element - 1]


def _vanishing(
    elements: Sequence[Element], generators: Sequence[VectorField], state: Symbols
) -> frozenset[Element]:
    """Elements that are zero as fields."""
    fields: dict[Element, VectorField] = dict(enumerate(generators, start=1))
    for element in elements:
        if isinstance(element, Bracket):
            left, right = fields[element.left], fields[element.right]
            fields[element] = lie_bracket(left, right, state)
    zeros = vanishing([fields[element] for element in elements], state)
    return frozenset(e for e, zero in zip(elements, zeros, strict=True) if zero)


def _largest_ideal(
    zero: frozenset[Element], elements: Sequence[Element], generators: int
) -> frozenset[Element]:
    """The elements among those that vanish whose brackets are all among them, too."""
    kept = set(elements) - zero
    ideal = set(zero)
    while True:
        needed = {
            lost
            for lost in ideal
            for generator in range(1, generators + 1)
            if kept & structure_constants(generator, lost).keys()
        }
        if not needed:
            return frozenset(ideal)
        ideal -= needed
        kept |= needed


def _tree(element: Element, generators: Sequence[str]) -> Tree:
    """A Hall element with fields for its generators' numbers."""
    return relabel(parse_names(str(element)), lambda i: generators[int(i) - 1])


def _index(tree: Tree, basis: Sequence[str]) -> int:
    name = name_of(tree)
    if name in basis:
        return basis.index(name)
    turned = name_of((tree[1], tree[0])) if isinstance(tree, tuple) else name
    way_out = f"write {turned}" if turned in basis else "choose among the Hall basis"
    raise ValueError(
        f"element {name} is not in the Hall basis over the fields in order of "
        f"appearance; {way_out}"
    )
