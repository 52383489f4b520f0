"""Shape coordinates: those that every field moves at a constant rate.

Such are the angles of legs. Their course along a plan is a running sum, so ranges are
checked and sweeps are centred without integrating anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.errors import RangeError, unknown
from planner.numerics.arrays import Array
from planner.systems.fields import NumericField, VectorField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

ShapeLimits = Mapping[str, tuple[float, float]]
OVERSTEP = 1e-9  # by which a range may be overstepped: rounding


@dataclass(frozen=True, eq=False)
class ShapeCoordinates:
    """Rates of a system's shape coordinates along its fields."""

    system: StratifiedSystem

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the whole state."""
        return tuple(map(str, self.system.state))

    @cached_property
    def rates(self) -> dict[str, Array]:
        """For each field the rates of all coordinates, nan where not constant."""
        size = self.system.dimension
        return {name: _rates(field, size) for name, field in self.system.fields.items()}

    @cached_property
    def coordinates(self) -> frozenset[int]:
        """Indices of the coordinates that every field moves at a constant rate."""
        constant = np.all([np.isfinite(rates) for rates in self.rates.values()], axis=0)
        return frozenset(int(i) for i in np.flatnonzero(constant))

    @cached_property
    def free(self) -> dict[str, tuple[int, float]]:
        """Fields that move one shape coordinate alone, one that nothing depends on.

        The coordinate's index and rate for each. Their flows can go anywhere, and as
        far as one likes, without moving the body.
        """
        used = set().union(
            *(_symbols(field) for field in self.system.fields.values()),
            *(
                f.free_symbols
                for functions in self.system.level_sets.values()
                for f in functions
            ),
        )
        inert = {i for i in self.coordinates if self.system.state[i] not in used}
        if any(
            isinstance(field, NumericField) for field in self.system.fields.values()
        ):
            inert = set()  # what a function depends on cannot be read off
        moved = {name: np.flatnonzero(rates) for name, rates in self.rates.items()}
        return {
            name: (int(i[0]), float(self.rates[name][i[0]]))
            for name, i in moved.items()
            if len(i) == 1 and int(i[0]) in inert
        }

    def trajectory(self, coordinate: int, flows: Iterable[Flow], start: float) -> Array:
        """Values of one shape coordinate before, between and after flows."""
        steps = [self.rates[flow.field][coordinate] * flow.duration for flow in flows]
        return np.cumsum([start, *steps])

    def require_limits(self, limits: ShapeLimits) -> None:
        """Refuse limits that bound nothing.

        Raises:
            ValueError: A limit names no shape coordinate, or is empty.
        """
        for name, (low, high) in limits.items():
            self._index(name, low, high)

    def require_within(
        self, limits: ShapeLimits, flows: Iterable[Flow], start: Array
    ) -> None:
        """Refuse flows that leave the range of a shape coordinate.

        Raises:
            ValueError: A limit names no shape coordinate, or is empty.
            RangeError: The flows leave it; it does not know how many segments would do.
        """
        flows = tuple(flows)
        for name, (low, high) in limits.items():
            values = self.trajectory(
                self._index(name, low, high), flows, start[self.names.index(name)]
            )
            worst = values[np.maximum(values - high, low - values).argmax()]
            if not low - OVERSTEP <= worst <= high + OVERSTEP:
                raise RangeError(name, float(worst), low, high)

    def _index(self, name: str, low: float, high: float) -> int:
        if name not in self.names:
            raise ValueError(f"limit of {name}, which {unknown(name, self.names)}")
        if not low < high:
            raise ValueError(
                f"limits of {name} are empty: {low} to {high}; give the lower one first"
            )
        if (index := self.names.index(name)) not in self.coordinates:
            raise ValueError(
                f"limit of {name}: some field moves it at a rate that varies, or that "
                "only a function knows; limit coordinates of constant rates"
            )
        return index


def _rates(field: VectorField, size: int) -> Array:
    if isinstance(field, NumericField):
        return np.full(size, np.nan)
    return np.array([float(e) if e.is_number else np.nan for e in field])


def _symbols(field: VectorField) -> set[object]:
    return set() if isinstance(field, NumericField) else set(field.free_symbols)
