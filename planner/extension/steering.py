"""From fictitious inputs to Hall coordinates to words of real inputs, eqs. (9), (20).

Brackets outside the selected elements have Hall coordinates too, in degree 2 h_ij' =
h_i v_j. They are realised as well, unless their fields vanish.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from numbers import Integral
from typing import Literal

import numpy as np

from planner.errors import message
from planner.extension.bracket_fields import HallFields, hall_fields
from planner.extension.rectangles import Rectangles, rectangles, sign_choices, weights
from planner.lie.coordinates import integrate
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import Bracket
from planner.lie.input_words import (
    Order,
    Spelling,
    joined,
    mirrored_spellings,
    scaled,
    short_durations,
    spellings,
)
from planner.numerics.arrays import Array
from planner.systems.elements import Tree, leaves
from planner.systems.flows import Word
from planner.systems.strata import StratifiedSystem

Spelled = Literal["backward", "forward", "backward-turned", "forward-turned"]
Wording = Literal[Spelled, "shortest", "alternating"]
MOST_SIGNED = 4  # generators whose signs are tried, all combinations of them
MOST_COORDINATES = 500  # of a segment; its words are far longer still


@dataclass(frozen=True, eq=False)
class Steering:
    """Hall coordinates over the generators of an extended system.

    Attributes:
        hall: The generators, in order of first appearance among the elements, and the
            Hall basis over them up to the degree of the approximation.
        selected: Index in the basis of each selected element.
        degree: Degree of the nilpotent approximation: words are exact where all
            brackets beyond it vanish.
        rectangles: In which units words are spelled, and from which corner and in which
            shape they run their rectangles; None for the words of the paper, with
            inputs as they are declared.

    Example:
        >>> import numpy as np
        >>> from planner import EXAMPLES, extend
        >>> steering = extend(EXAMPLES["heisenberg"], ["f", "g", "[f,g]"]).steering
        >>> steering.words(np.array([[0.0, 0.0, 1.0]]), "backward")
        [Word(fields=('f', 'g', 'f', 'g'), durations=[1.0, 1.0, -1.0, -1.0])]
    """

    hall: HallFields
    selected: tuple[int, ...]
    degree: int
    rectangles: Rectangles | None

    @property
    def selected_degrees(self) -> tuple[int, ...]:
        """Degree of each selected element."""
        return tuple(lie_algebra(self.hall.elements).degrees[j] for j in self.selected)

    @property
    def raised(self) -> bool:
        """Whether the approximation goes beyond the degree of the elements."""
        return self.degree > max(self.selected_degrees)

    @property
    def basis(self) -> tuple[str, ...]:
        """Names of the Hall coordinates."""
        return self.hall.names

    def hall_coordinates(self, inputs: Array) -> Array:
        """Backward Hall coordinates that inputs reach in unit time, eq. (9).

        Fictitious inputs of the selected elements at collocation nodes have shape
        (segments, nodes, p), the coordinates (segments, s) in the order of `basis`.
        """
        everywhere = np.zeros((*inputs.shape[:-1], len(self.basis)))
        everywhere[..., list(self.selected)] = inputs
        return integrate(self.hall.elements, everywhere)

    def words(
        self, hall_coordinates: Array, order: Wording, at: Array | None = None
    ) -> list[Word]:
        """Words of the generators that realise Hall coordinates, one for each segment.

        `backward` runs brackets first, `forward` generators first; turned, the
        generators themselves run in the other order. `shortest` takes short words
        where two fields have the only bracket, and the shorter of the first two
        elsewhere. `alternating` mirrors every second of the backward words. The
        coordinates are backward ones (segments, s). With the configurations (segments,
        n) that segments start from, units and rectangles are those of `rectangles`
        there; without either, words are those that are printed.
        """
        if at is None:
            return self.scaled_words(hall_coordinates, order)
        return self.speller(hall_coordinates, at)(order)

    def speller(
        self, hall_coordinates: Array, at: Array
    ) -> Callable[[Wording], list[Word]]:
        """The words in any order, as `words` gives them; each is spelled only once."""
        measured, units = self.measured(hall_coordinates, at)

        @cache
        def rectangular() -> Array:
            if self.rectangles is None:
                return units
            return self.rectangles.scales(measured, at, units)

        @cache
        def spelled(order: Wording) -> list[Word]:
            plain = order in ("backward", "forward")
            return self.scaled_words(measured, order, rectangular() if plain else units)

        return spelled

    def scaled_words(
        self, hall_coordinates: Array, order: Wording, scales: Array | None = None
    ) -> list[Word]:
        """Words whose flows are measured in other units, or run backward.

        All realise the same coordinates, and differ in brackets beyond. Scales have
        shape (segments, m) or (m,); without them words are those that are printed.
        """
        shape = len(hall_coordinates), len(self.hall.generators)
        scales = np.broadcast_to(1.0 if scales is None else scales, shape)
        measured = hall_coordinates / weights(self.hall.elements, scales)
        if order == "shortest":
            spelled = list(map(scaled, self._short(measured), scales))
        elif order == "alternating":
            spelled = self._alternating(measured, scales)
        else:
            spelled = self._spelled(measured, order, scales)
        names = self.hall.generators
        patterns = {letters for letters, _ in spelled}
        fields = {letters: tuple(names[i - 1] for i in letters) for letters in patterns}
        return [Word(fields[letters], durations) for letters, durations in spelled]

    def measured(self, hall_coordinates: Array, at: Array) -> tuple[Array, Array]:
        """Coordinates without rounding, and units of the inputs, (segments, m).

        Without `rectangles` the coordinates are as given, and the units are one.
        """
        if self.rectangles is None:
            return hall_coordinates, np.ones((len(at), len(self.hall.generators)))
        return self.rectangles.units.measured(hall_coordinates, at)

    def element_units(self, x: Array) -> Array | None:
        """Units of the selected elements' inputs at x of shape (n,), shape (p,)."""
        if self.rectangles is None:
            return None
        every = weights(self.hall.elements, self.rectangles.units.at(x))
        return np.asarray(every[list(self.selected)])

    @property
    def signs(self) -> Array:
        """Ways to run generators forward or backward, the printed one first, (w, m).

        Generators that commute with all others run as they are printed, and so do all
        where there are more than `MOST_SIGNED` of the rest.
        """
        tried = self.hall.entangled
        few = tried if len(tried) <= MOST_SIGNED else ()
        return sign_choices(len(self.hall.generators), few)

    def _spelled(
        self, hall_coordinates: Array, order: Spelled, scales: Array
    ) -> list[Spelling]:
        plain: Order = "backward" if order.startswith("backward") else "forward"
        known = self.hall.elements, hall_coordinates, plain, self.hall.vanishing
        return spellings(*known, turned=order.endswith("-turned"), units=scales)

    def _alternating(self, hall_coordinates: Array, scales: Array) -> list[Spelling]:
        spelled = self._spelled(hall_coordinates, "backward", scales)
        known = self.hall.elements, hall_coordinates[1::2], max(self.selected_degrees)
        mirrored = mirrored_spellings(*known, self.hall.vanishing)
        spelled[1::2] = map(scaled, mirrored, scales[1::2])
        return spelled

    def _short(self, h: Array) -> list[Spelling]:
        """Short words for two fields, the shorter of two for others, not yet scaled."""
        if self.hall.only_pair is None:
            units = np.ones((len(h), len(self.hall.generators)))
            backward = self._spelled(h, "backward", units)
            pairs = zip(backward, self._spelled(h, "forward", units), strict=True)
            return [min(p, key=lambda word: sum(map(abs, word[1]))) for p in pairs]
        first, second = self.hall.only_pair
        count = len(self.hall.generators)
        pair = short_durations(h[:, first - 1], h[:, second - 1], h[:, count])
        apart = [i for i in range(1, count + 1) if i not in (first, second)]
        generators = (first, second, first, second, first, *apart)
        durations = np.hstack([pair, h[:, [i - 1 for i in apart]]])
        return [joined(generators, row) for row in durations.tolist()]


def steering(
    system: StratifiedSystem, trees: Sequence[Tree], degree: int | None = None
) -> Steering:
    """Prepare the Hall coordinates of selected elements over field names.

    The nilpotent approximation has the elements' highest degree if none is given.
    """
    generators = tuple(dict.fromkeys(chain(*map(leaves, trees))))
    highest = max(len(leaves(tree)) for tree in trees)
    degree = highest if degree is None else degree
    if not isinstance(degree, Integral) or isinstance(degree, bool):
        raise ValueError(f"degree is {degree!r}; a whole number is needed")
    if degree < highest:
        raise ValueError(message("degree", degree=degree, highest=highest))
    hall = hall_fields(system, generators, degree, MOST_COORDINATES)
    selected = tuple(_index(tree, hall.names) for tree in trees)
    return Steering(hall, selected, degree, rectangles(system, hall))


def _index(tree: Tree, basis: Sequence[str]) -> int:
    name = str(tree)
    if name in basis:
        return basis.index(name)
    turned = f"[{tree.right},{tree.left}]" if isinstance(tree, Bracket) else name
    way_out = f"write {turned}" if turned in basis else "choose from the Hall basis"
    raise ValueError(message("not_in_basis", name=name, way_out=way_out))
