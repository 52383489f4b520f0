"""Values of fields in which rounding errors are distinguished from small values.

Every value is accompanied by its weight: the size of the terms that it is a sum of,
propagated through products and functions as errors propagate. A value below `ROUNDING`
times its weight is the rounding error of terms that cancel, and counts as zero; any
other counts as different from zero, in whatever unit. This suits formulas that are
evaluated once; others are compiled by `systems.fields.compile_fields`.
"""

from collections.abc import Callable, Sequence
from functools import cache, reduce

import numpy as np
import sympy as sp

from planner.numerics.arrays import ROUNDING, Array
from planner.systems.fields import (
    KINKS,
    NumericField,
    Symbols,
    VectorField,
    sample_configurations,
)

TRUSTED = 1e-9  # takes the place of ROUNDING for functions, whose terms are unknown
FARTHER = 10.0  # times as far away formulas must vanish, too, to count as zero
NUDGE = 1e-6  # change of an argument over its weight, by which slopes are estimated

Weighed = tuple[Array, Array]  # values and their weights, broadcastable to (points,)


class WeighedValues:
    """Values of formulas at given configurations; terms are evaluated once.

    Coordinates are taken to be known to within `ROUNDING` times the larger of their
    magnitude and 1.
    """

    def __init__(self, state: Symbols, points: Array) -> None:
        """Take the symbols of a state and configurations of shape (points, n)."""
        self.points = points
        self._state = state
        self._known: dict[sp.Basic, Weighed] = {
            symbol: (x, np.maximum(np.abs(x), 1.0))
            for symbol, x in zip(state, points.T, strict=True)
        }

    def __call__(self, column: VectorField) -> Array:
        """Values of formulas, (points, rows); not finite where a field is singular."""
        if isinstance(column, NumericField):
            with np.errstate(all="ignore"):
                values = np.array([column(x) for x in self.points])
                sizes = np.array([column.weight(x) for x in self.points])
            largest = np.where(np.isfinite(sizes), sizes, 0.0).max()
            return np.where(np.abs(values) <= TRUSTED * largest, 0.0, values)
        with np.errstate(all="ignore"):
            rows = [self._settled(entry) for entry in column]
        return np.stack(np.broadcast_arrays(self.points[:, 0], *rows)[1:], axis=1)

    def _settled(self, entry: sp.Expr) -> Array:
        value, weight = self._weighed(entry)
        rounding = np.isfinite(value) & (np.abs(value) <= ROUNDING * weight)
        return np.where(rounding, 0.0, value)

    def _weighed(self, entry: sp.Expr) -> Weighed:
        if entry not in self._known:
            self._known[entry] = self._evaluated(entry)
        return self._known[entry]

    def _evaluated(self, entry: sp.Expr) -> Weighed:
        if entry.is_Number or entry.is_NumberSymbol:
            value = np.asarray(float(entry) if entry.is_extended_real else np.nan)
            return value, np.abs(value)
        parted = not all(isinstance(part, sp.Expr) for part in entry.args)  # in cases
        if parted or isinstance(entry, sp.DiracDelta):  # of an order, a whole number
            function = sp.lambdify(self._state, entry, modules=[KINKS, np])
            value = np.asarray(function(*self.points.T), dtype=float)
            return value, np.abs(value)
        parts = [self._weighed(part) for part in entry.args]
        if entry.is_Add:
            values, weights = zip(*parts, strict=True)
            return sum(values[1:], values[0]), sum(weights[1:], weights[0])
        if entry.is_Mul:
            return reduce(_times, parts)
        return _carried(_function(entry.func, len(parts)), parts)


def vanishing(fields: Sequence[VectorField], state: Symbols) -> tuple[bool, ...]:
    """Which fields are zero everywhere, judged at random configurations.

    An analytic field that vanishes at random points vanishes everywhere, so no formula
    is simplified. Points where a field is singular are passed over, unless all are.
    Python functions are evaluated near the origin only.
    """
    near = sample_configurations(len(state))
    formulas = WeighedValues(state, np.vstack([near, FARTHER * near]))
    functions = WeighedValues(state, near)

    def vanishes(field: VectorField) -> bool:
        values = (functions if isinstance(field, NumericField) else formulas)(field)
        finite = np.isfinite(values)
        return bool(finite.all(axis=1).any() and not values[finite].any())

    return tuple(map(vanishes, fields))


def _times(one: Weighed, other: Weighed) -> Weighed:
    return one[0] * other[0], one[1] * np.abs(other[0]) + np.abs(one[0]) * other[1]


def _carried(function: Callable[..., Array], parts: Sequence[Weighed]) -> Weighed:
    """Values of a function; the weight of each argument is multiplied by the slope."""
    arguments = [value for value, _ in parts]
    value = function(*arguments)
    weight = np.abs(value)
    for k, (argument, its_weight) in enumerate(parts):
        nudged = [*arguments]
        nudged[k] = argument + NUDGE * its_weight
        slope = np.abs(function(*nudged) - value) / NUDGE
        weight = weight + np.where(np.isfinite(slope), slope, 0.0)
    return value, weight


@cache
def _function(function: type[sp.Expr], count: int) -> Callable[..., Array]:
    """A function of expressions as a function of arrays."""
    if function is sp.Pow:
        return np.float_power
    arguments = [sp.Dummy(real=True) for _ in range(count)]
    return sp.lambdify(
        arguments, function(*arguments, evaluate=False), modules=[KINKS, np]
    )
