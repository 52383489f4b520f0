"""The cost of one unit of motion in each direction, counted in strokes of the inputs.

Brackets may give a direction in theory although it cannot be used in practice: if a
bracket is very small, no range of the joints moves the system far along it. The rank of
a matrix does not distinguish the two cases, but the number of strokes does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from planner.extension.extended import extend
from planner.numerics.arrays import Array
from planner.systems.elements import Tree, leaves, parse
from planner.systems.strata import StratifiedSystem

AFFORDABLE = 10_000.0
"""Strokes for a unit of a direction, beyond which it is given in theory only."""
MISSED = 1e-6  # of a unit of any coordinate


@dataclass(frozen=True, slots=True)
class DirectionCost:
    """Cost of moving a coordinate by one unit.

    Attributes:
        direction: Name of the coordinate.
        element: Element that most of the motion comes from, the first of equal ones.
        strokes: Number of strokes; infinite where the elements do not give it.
    """

    direction: str
    element: str
    strokes: float

    @property
    def in_theory_only(self) -> bool:
        """Whether no reasonable number of strokes gives it."""
        return not self.strokes <= AFFORDABLE


def stroke_costs(
    system: StratifiedSystem,
    elements: Sequence[str],
    at: ArrayLike,
    strokes: Mapping[str, float],
) -> tuple[DirectionCost, ...]:
    """Cost of a unit of each coordinate that is no stroke itself.

    Args:
        system: System to move.
        elements: Elements that it is steered by.
        at: Configuration, shape (n,).
        strokes: Length of a stroke of each field in the units of its input; 1 for
            those left out.

    Raises:
        PlannerError: An element vanishes everywhere, or cannot be followed.
    """
    extended = extend(system, elements)
    matrix = extended.columns(np.asarray(at, dtype=float))  # (n, p)
    trees = [parse(name, system) for name in elements]
    prices = np.array([_price(tree, strokes) for tree in trees])
    degrees = np.array([len(leaves(tree)) for tree in trees])
    joints = {index for index, _ in extended.shape.recoveries.values()}
    moved = np.flatnonzero(np.abs(matrix).max(axis=1) > 0)
    return tuple(
        _cost(str(system.state[i]), matrix, prices, degrees, int(i), elements)
        for i in moved
        if int(i) not in joints
    )


def _cost(
    name: str,
    matrix: Array,
    prices: Array,
    degrees: Array,
    row: int,
    elements: Sequence[str],
) -> DirectionCost:
    """The strokes for a unit of one row, by elements of low degree if they suffice.

    The motion may miss a millionth of a unit, which is not worth further strokes.
    """
    unit = np.eye(len(matrix))[row]
    scaled = matrix / prices  # one stroke of each
    for degree in np.unique(degrees):
        usable = np.where(degrees <= degree, scaled, 0.0)
        for amounts in _solutions(usable, unit):
            if np.abs(usable @ amounts - unit).max() < MISSED:
                given = np.abs(usable[row] * amounts).round(9)  # parts of the unit
                main = elements[int(given.argmax())]
                return DirectionCost(name, main, float(np.abs(amounts).sum()))
    return DirectionCost(name, elements[int(np.abs(amounts).argmax())], inf)


def _solutions(scaled: Array, unit: Array) -> Iterator[Array]:
    """Least squares with rows as they are, and with rows of equal size."""
    size = np.abs(scaled).max(axis=1)
    rows = size > 0
    for weight in (np.ones(len(size)), np.where(rows, size, 1.0)):
        amounts, *_ = np.linalg.lstsq(
            (scaled / weight[:, None])[rows], (unit / weight)[rows], rcond=None
        )
        yield amounts


def _price(tree: Tree, strokes: Mapping[str, float]) -> float:
    """Strokes for a unit of an element: those of its word, over the area they span."""
    area = float(np.prod([strokes.get(leaf, 1.0) for leaf in leaves(tree)]))
    return _letters(tree) / area


def _letters(tree: Tree) -> int:
    """Number of flows in the word of an element."""
    return 1 if isinstance(tree, str) else 2 * (_letters(tree[0]) + _letters(tree[1]))
