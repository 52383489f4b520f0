"""The cost of one unit of motion in each direction, counted in strokes of the inputs.

Brackets may give a direction in theory although no range of the joints moves the system
far along it. The rank of a matrix does not show this, but the number of strokes does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from planner.extension.extended import extend
from planner.lie.input_words import letters_of
from planner.numerics.arrays import Array
from planner.systems.elements import leaves, parse
from planner.systems.strata import StratifiedSystem

AFFORDABLE = 10_000.0  # strokes a unit; more make a direction one in theory only


@dataclass(frozen=True, slots=True)
class DirectionCost:
    """Cost of moving a coordinate by one unit."""

    direction: str  # name of the coordinate
    element: str  # that most of the motion comes from, the first of equal ones
    strokes: float  # infinite where the elements do not give the direction

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
    """Cost of a unit of each coordinate that is no stroke itself, at x of shape (n,).

    `strokes` gives the length of a stroke of each field in the units of its input, 1
    for those left out. An element costs the strokes of its word over the area that
    they span. Raises `PlannerError` if an element vanishes or cannot be followed.
    """
    extended = extend(system, elements)
    matrix = extended.columns(np.asarray(at, dtype=float))  # (n, p)
    trees = [parse(name, system) for name in elements]
    areas = [np.prod([strokes.get(leaf, 1.0) for leaf in leaves(t)]) for t in trees]
    scaled = matrix / np.divide([len(letters_of(tree)) for tree in trees], areas)
    degrees = np.array([len(leaves(tree)) for tree in trees])
    joints = {index for index, _ in extended.shape.recoveries.values()}
    return tuple(
        _cost(str(system.state[i]), i, scaled, degrees, elements)
        for i in sorted(set(np.flatnonzero(matrix.any(axis=1)).tolist()) - joints)
    )


def _cost(
    name: str, row: int, scaled: Array, degrees: Array, elements: Sequence[str]
) -> DirectionCost:
    """The strokes for a unit of one row, by elements of low degree if they suffice.

    A column of the matrix, shape (n, p), is one stroke of an element. The motion may
    miss a millionth of a unit, which is not worth further strokes. Rows are weighed as
    they are, or made of equal size.
    """
    unit = np.eye(len(scaled))[row]
    for degree in np.unique(degrees):
        usable = np.where(degrees <= degree, scaled, 0.0)
        size = np.abs(usable).max(axis=1)
        rows = size > 0
        for weight in (np.ones(len(size)), np.where(rows, size, 1.0)):
            weighed, wanted = (usable / weight[:, None])[rows], (unit / weight)[rows]
            amounts, *_ = np.linalg.lstsq(weighed, wanted, rcond=None)
            if np.abs(usable @ amounts - unit).max() < 1e-6:
                given = np.abs(usable[row] * amounts).round(9)  # parts of the unit
                main = elements[int(given.argmax())]
                return DirectionCost(name, main, float(np.abs(amounts).sum()))
    return DirectionCost(name, elements[int(np.abs(amounts).argmax())], inf)
