"""Shape coordinates, such as angles of legs: those that fields move at constant rates.

Their trajectory along a plan is a cumulative sum, so ranges are checked and strokes are
centred without integration.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from planner.errors import RangeError, message, require_known
from planner.numerics.arrays import Array
from planner.systems.fields import NumericField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

ShapeLimits = Mapping[str, tuple[float, float]]
OVERSTEP = 1e-9  # excess over a range that is taken for rounding


@dataclass(frozen=True, eq=False)
class ShapeCoordinates:
    """The shape coordinates of a system, and their rates along its fields."""

    system: StratifiedSystem

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all coordinates of the state."""
        return tuple(map(str, self.system.state))

    @cached_property
    def rates(self) -> dict[str, Array]:
        """Rates of all coordinates along each field, nan where not constant."""
        unknown = np.full(self.system.dimension, np.nan)
        return {
            name: unknown
            if isinstance(field, NumericField)
            else np.array([float(e) if e.is_number else np.nan for e in field])
            for name, field in self.system.fields.items()
        }

    @cached_property
    def coordinates(self) -> frozenset[int]:
        """Indices of the coordinates that every field moves at a constant rate."""
        constant = np.all([np.isfinite(rates) for rates in self.rates.values()], axis=0)
        return frozenset(int(i) for i in np.flatnonzero(constant))

    @cached_property
    def inert(self) -> frozenset[int]:
        """Indices of shape coordinates on which no field depends, such as joints."""
        fields = self.system.fields.values()
        if any(isinstance(field, NumericField) for field in fields):
            return frozenset()  # it is unknown what a Python function depends on
        formulas = [*fields, *chain(*self.system.level_sets.values())]
        used = set().union(*(formula.free_symbols for formula in formulas))
        state = self.system.state
        return frozenset(i for i in self.coordinates if state[i] not in used)

    @cached_property
    def recoveries(self) -> dict[str, tuple[int, float]]:
        """Index and rate of the shape coordinate that each recovery moves.

        A recovery moves this one coordinate alone, and no field depends on it: its
        flows commute with all others and do not move the body.
        """
        moved = {name: np.flatnonzero(rates) for name, rates in self.rates.items()}
        return {
            name: (int(i[0]), float(self.rates[name][i[0]]))
            for name, i in moved.items()
            if len(i) == 1 and int(i[0]) in self.inert
        }

    def trajectory(self, coordinate: int, flows: Iterable[Flow], start: float) -> Array:
        """Values of a shape coordinate before the first flow and after each flow."""
        steps = [self.rates[flow.field][coordinate] * flow.duration for flow in flows]
        return np.cumsum([start, *steps])

    def require_limits(self, limits: ShapeLimits) -> None:
        """Raise `ValueError` unless limits name shape coordinates, low before high."""
        for name, (low, high) in limits.items():
            self._index(name, low, high)

    def require_within(
        self, limits: ShapeLimits, flows: Iterable[Flow], start: Array
    ) -> None:
        """Check that flows keep every shape coordinate within its range.

        Raises `RangeError` if they leave a range. It suggests no number of segments,
        since more of them may not help.
        """
        flows = tuple(flows)
        for name, (low, high) in limits.items():
            index = self._index(name, low, high)
            values = self.trajectory(index, flows, start[index])
            worst = values[np.maximum(values - high, low - values).argmax()]
            if not low - OVERSTEP <= worst <= high + OVERSTEP:
                raise RangeError(name, float(worst), low, high)

    def _index(self, name: str, low: float, high: float) -> int:
        require_known(f"limit of {name}, which", name, self.names)
        if not low < high:
            raise ValueError(message("no_room", name=name, low=low, high=high))
        if (index := self.names.index(name)) not in self.coordinates:
            raise ValueError(message("limit", name=name))
        return index
