"""From fictitious inputs to Hall coordinates to words of real inputs, many at a time.

Generators that commute with all others as fields stand apart: their coordinates are
plain integrals and their flows fit anywhere. Only the rest needs the free Lie algebra,
whose brackets outside the selected elements get coordinates too and are realised
unless their fields vanish.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
import sympy as sp

from planner.collocation import collocation
from planner.coordinates import backward_matrix
from planner.elements import Tree, column, leaves, name_of, parse_names, relabel
from planner.fields import Array, lie_bracket, vanishing
from planner.hall import Element, hall_basis
from planner.realise import word
from planner.strata import StratifiedSystem

Order = Literal["backward", "forward"]
Word = list[tuple[str, float]]
Rates = Callable[..., Sequence[Array | float]]

NEGLIGIBLE = 1e-12  # durations below this are rounding


@dataclass(frozen=True, eq=False)
class Steering:
    """Hall coordinates over the generators of an extended system.

    Attributes:
        generators: Fields in order of first appearance among the elements.
        entangled: Those that do not commute with all others, in the same order.
        elements: Hall basis over `entangled`, up to the elements' highest degree.
        coordinates: Names of all Hall coordinates: generators, then the brackets among
            `elements`.
        kept: Indices in `coordinates` of those whose fields do not vanish.
        selected: Index in `coordinates` of each selected element.
        places: Index in `coordinates` of each of `elements`.
        rates: For each degree from 2 on, indices of brackets and their rates h' as a
            function of all h and v (eq. 9).
        clashing: Pairs of generators that do not commute.
    """

    generators: tuple[str, ...]
    entangled: tuple[str, ...]
    elements: tuple[Element, ...]
    coordinates: tuple[str, ...]
    kept: tuple[int, ...]
    selected: tuple[int, ...]
    places: tuple[int, ...]
    rates: tuple[tuple[tuple[int, ...], Rates], ...]
    clashing: frozenset[frozenset[str]]

    def commute(self, a: str, b: str) -> bool:
        """Whether the flows of two generators may be interchanged."""
        return frozenset((a, b)) not in self.clashing

    @property
    def basis(self) -> tuple[str, ...]:
        """Names of the Hall coordinates that matter."""
        return tuple(self.coordinates[k] for k in self.kept)

    def hall_coordinates(self, inputs: Array) -> Array:
        """Backward Hall coordinates that inputs reach in unit time, eq. (9).

        Args:
            inputs: Fictitious inputs of the selected elements at collocation nodes,
                shape (segments, nodes, p).

        Returns:
            Shape (segments, s), in the order of `basis`.
        """
        segments, nodes, _ = inputs.shape
        integral = collocation(nodes).integral.T
        v = np.zeros((len(self.coordinates), segments, nodes))
        v[list(self.selected)] = np.moveaxis(inputs, -1, 0)
        h = v @ integral  # of the generators; brackets follow degree by degree
        for rows, rates in self.rates:
            for row, rate in zip(rows, rates(*h, *v), strict=True):
                h[row] = np.broadcast_to(rate, (segments, nodes)) @ integral
        return np.ascontiguousarray(h[list(self.kept), :, -1].T)

    def words(self, hall_coordinates: Array, order: Order) -> list[Word]:
        """Flows of the generators that realise Hall coordinates, one word a segment.

        Args:
            hall_coordinates: Backward coordinates, shape (segments, s).
            order: `backward` runs brackets first, `forward` generators first.

        Returns:
            For each segment fields and signed durations in time order; those that
            commute with all others come last.
        """
        everywhere = np.zeros((len(hall_coordinates), len(self.coordinates)))
        everywhere[:, list(self.kept)] = hall_coordinates
        entangled = everywhere[:, list(self.places)]
        words = [self._word(h, order) for h in entangled]
        free = [
            k for k, name in enumerate(self.generators) if name not in self.entangled
        ]
        for one, durations in zip(words, everywhere[:, free].tolist(), strict=True):
            swings = zip(free, durations, strict=True)
            one += [(self.generators[k], t) for k, t in swings if abs(t) > NEGLIGIBLE]
        return words

    def _word(self, h: Array, order: Order) -> Word:
        return [(self.entangled[i - 1], t) for i, t in word(self.elements, h, order)]


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
    entangled = tuple(g for g in generators if any(g in pair for pair in clashing))
    highest = max(len(leaves(tree)) for tree in trees)
    elements = hall_basis(len(entangled), highest) if entangled else ()
    free = [
        relabel(parse_names(str(e)), lambda i: entangled[int(i) - 1]) for e in elements
    ]
    brackets = free[len(entangled) :]
    coordinates = (*generators, *map(name_of, brackets))
    zero = vanishing([column(tree, system) for tree in brackets], system.state)
    kept = [*range(len(generators))]
    kept += [k for k, gone in enumerate(zero, start=len(generators)) if not gone]
    selected = tuple(_index(tree, coordinates) for tree in trees)
    places = tuple(coordinates.index(name_of(tree)) for tree in free)
    rates = (
        _rates(elements, places, free, selected, len(coordinates)) if brackets else ()
    )
    return Steering(
        generators,
        entangled,
        elements,
        coordinates,
        tuple(kept),
        selected,
        places,
        rates,
        clashing,
    )


def _clashing(
    system: StratifiedSystem, names: Sequence[str]
) -> frozenset[frozenset[str]]:
    """Pairs of fields that do not commute."""
    pairs = list(combinations(names, 2))
    brackets = [
        lie_bracket(system.fields[a], system.fields[b], system.state) for a, b in pairs
    ]
    commuting = vanishing(brackets, system.state)
    return frozenset(
        frozenset(p) for p, free in zip(pairs, commuting, strict=True) if not free
    )


def _index(tree: Tree, coordinates: Sequence[str]) -> int:
    name = name_of(tree)
    if name in coordinates:
        return coordinates.index(name)
    turned = name_of((tree[1], tree[0])) if isinstance(tree, tuple) else name
    way_out = (
        f"write {turned}" if turned in coordinates else "choose among the Hall basis"
    )
    raise ValueError(
        f"element {name} is not in the Hall basis over the fields in order of "
        f"appearance; {way_out}"
    )


def _rates(
    elements: Sequence[Element],
    place: Sequence[int],
    free: Sequence[Tree],
    selected: Sequence[int],
    size: int,
) -> tuple[tuple[tuple[int, ...], Rates], ...]:
    """Compile h' = A(h) v for the brackets, eq. (9), one function a degree."""
    h = sp.symbols(f"h1:{len(elements) + 1}")
    v = [
        sp.Symbol(f"v{k}") if place[k] in selected else sp.S.Zero
        for k in range(len(elements))
    ]
    slopes = backward_matrix(elements) * sp.Matrix(v)
    everywhere = sp.symbols(f"h_0:{size}"), sp.symbols(f"v_0:{size}")
    renamed = {h[k]: everywhere[0][place[k]] for k in range(len(elements))}
    renamed |= {
        sp.Symbol(f"v{k}"): everywhere[1][place[k]] for k in range(len(elements))
    }
    compiled = []
    for degree in range(2, len(leaves(free[-1])) + 1):
        rows = [k for k, tree in enumerate(free) if len(leaves(tree)) == degree]
        expressions = [slopes[k].xreplace(renamed) for k in rows]
        rates = sp.lambdify([*everywhere[0], *everywhere[1]], expressions, cse=True)
        compiled.append((tuple(place[k] for k in rows), rates))
    return tuple(compiled)
