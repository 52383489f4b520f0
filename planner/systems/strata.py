"""Stratified systems: a state, strata with their fields, and level sets (Def. 1).

The contacts of a stratum are its level sets. Where a system has no level sets, the
contacts are read from the name of the stratum, one character a contact and `0` for
none: S12 is `"12"`. No two strata have the same contacts. Two strata are neighbours in
the graph of Figs. 2 and 3 if the contacts of one contain those of the other and no
third stratum lies between them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from types import MappingProxyType

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from planner.errors import StratumError, message, point, require_known, unknown
from planner.numerics.arrays import Array
from planner.numerics.subspaces import directions_beyond
from planner.support.stopping import tick
from planner.systems import declaration
from planner.systems.fields import CompiledFields, Symbols, VectorField, compile_fields
from planner.systems.level_sets import LevelSet


class _Fields(dict[str, VectorField]):
    def __missing__(self, name: str) -> VectorField:
        raise ValueError(f"field {name} {unknown(name, self)}")


@dataclass(frozen=True, eq=False)
class StratifiedSystem:
    """A driftless system on each of several strata, eq. (10); on one, eq. (1).

    Attributes:
        state: Symbols of the configuration, n of them; names are accepted.
        strata: For each stratum its fields g_{I,j} by name: sympy columns of shape
            (n, 1), or functions of a configuration. Generators are numbered from 1 in
            the order of all fields.
        bottom: The bottom stratum S_B, in which plans start and end.
        level_sets: For each stratum the expressions Phi_i that vanish on it, such as
            the heights of its feet. A stratum without an entry is open.
        metric: By name of a coordinate, the length that a unit of it counts as, such as
            the feet's distance from the middle for a yaw [m/rad]; 1 where none is
            given. Distances are measured in it, and inputs compared.
        lifts: For each stratum the names of the fields that lift feet there (Sec. 5.1);
            found by their formulas where these leave no choice.

    Raises:
        ValueError: A part is misshapen or names something unknown, two strata have the
            same contacts, or a field is not tangent to its stratum.

    Example:
        >>> from planner import StratifiedSystem
        >>> fields = {"12": {}, "1": {"f": [1, 0, 0]}, "2": {"g": [0, 1, "x"]}}
        >>> walker = StratifiedSystem("x y z", fields, bottom="12")
        >>> walker.switches("1", "2")
        2
    """

    state: Symbols
    strata: Mapping[str, Mapping[str, VectorField]]
    bottom: str
    level_sets: Mapping[str, tuple[sp.Expr, ...]] = field(default_factory=dict)
    metric: Mapping[str, float] = field(default_factory=dict)
    lifts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    _compiled: dict[str, CompiledFields] = field(
        default_factory=dict, init=False, repr=False
    )

    def __post_init__(self) -> None:
        normalised = declaration.checked_state(self.state)
        strata = declaration.checked_strata(self.strata, normalised)
        level_sets = declaration.checked_level_sets(self.level_sets, strata, normalised)
        require_known(f"bottom {self.bottom!r}", self.bottom, strata)
        fixed = {stratum: MappingProxyType(own) for stratum, own in strata.items()}
        for name, value in (
            ("state", normalised),
            ("strata", MappingProxyType(fixed)),
            ("level_sets", level_sets),
            ("metric", declaration.checked_metric(self.metric, normalised)),
            ("lifts", declaration.checked_lifts(self.lifts, strata)),
        ):
            object.__setattr__(self, name, value)
        for name in self.strata if len(self.strata) > 1 else ():
            clear = len(set(name)) == len(name) and ("0" not in name or name == "0")
            if not (clear or self.level_sets):
                raise ValueError(message("contacts", name=name))
        seen: dict[frozenset[str], str] = {}
        for name, contacts in self.contacts.items():
            if (other := seen.setdefault(contacts, name)) != name:
                raise ValueError(message("alike", other=other, name=name))
        for stratum in self.strata:
            self._require_tangent_fields(stratum)

    def __reduce__(self) -> tuple[object, ...]:
        """Travel between processes and be copied, by all that was given."""
        given = self.bottom, self.level_sets, self.metric, self.lifts
        strata = {stratum: dict(own) for stratum, own in self.strata.items()}
        return type(self), (self.state, strata, *given)

    @property
    def dimension(self) -> int:
        """Number n of coordinates of the state."""
        return len(self.state)

    @cached_property
    def bottom_dimension(self) -> int:
        """Dimension of the bottom stratum."""
        return self.dimension_of(self.bottom)

    def dimension_of(self, stratum: str) -> int:
        """Dimension of a stratum: n minus the number of its level sets."""
        return self.dimension - len(self.level_set(stratum).functions)

    @cached_property
    def weights(self) -> Array:
        """Length that a unit of each coordinate counts as in the metric, (n,)."""
        return np.array([self.metric.get(str(s), 1.0) for s in self.state])

    def length(self, change: ArrayLike) -> Array:
        """Length of changes of the configuration, (..., n), in the metric."""
        return np.linalg.norm(np.multiply(change, self.weights), axis=-1)

    @cached_property
    def fields(self) -> dict[str, VectorField]:
        """All fields by name, in the order in which generators are numbered."""
        return _Fields(pair for own in self.strata.values() for pair in own.items())

    def compiled(self, name: str) -> CompiledFields:
        """A field as a numeric function, compiled at the first call."""
        if name not in self._compiled:
            compiled = compile_fields([self.fields[name]], self.state, [name])
            self._compiled[name] = compiled
        return self._compiled[name]

    @cached_property
    def stratum_of(self) -> dict[str, str]:
        """The stratum on which each field acts."""
        return {name: s for s, fields in self.strata.items() for name in fields}

    @cached_property
    def contacts(self) -> dict[str, frozenset[str]]:
        """Contacts of each stratum: its level sets, or the characters of its name."""
        named = {
            s: self.level_sets.get(s, ()) if self.level_sets else s for s in self.strata
        }
        return {s: frozenset(map(str, each)) - {"0"} for s, each in named.items()}

    def level_set(self, stratum: str) -> LevelSet:
        """The set where the functions of a stratum vanish; all of space if open."""
        return self._level_sets[stratum]

    @cached_property
    def _level_sets(self) -> dict[str, LevelSet]:
        given = self.level_sets
        return {s: LevelSet(given.get(s, ()), self.state) for s in self.strata}

    def missing(self, reached: Array, x: Array, stratum: str = "") -> tuple[str, ...]:
        """Directions of a stratum's tangent space at x outside a given space, as text.

        Orthonormal columns span the given space, shape (n, rank). The stratum is the
        bottom stratum if its name is empty.
        """
        gradients = self.level_set(stratum or self.bottom).gradients(x)
        return directions_beyond(np.hstack([reached, gradients]), self.state)

    @cached_property
    def edges(self) -> tuple[tuple[str, str], ...]:
        """Pairs of neighbours (lower, higher) in the graph of strata, Figs. 2 and 3."""
        found: list[tuple[str, str]] = []
        for low, own in self.contacts.items():
            tick()
            above = {name: c for name, c in self.contacts.items() if c < own}
            for high, c in above.items():
                if not any(c < other for other in above.values()):
                    found.append((low, high))
        return tuple(found)

    @cached_property
    def neighbours(self) -> dict[str, tuple[str, ...]]:
        """Neighbours of each stratum in the graph, those with more contacts first."""
        near: dict[str, list[str]] = {s: [] for s in self.strata}
        for low, high in self.edges:
            near[low].append(high)
            near[high].append(low)
        for others in near.values():
            others.sort(key=lambda stratum: -len(self.contacts[stratum]))
        return {stratum: tuple(others) for stratum, others in near.items()}

    def switches(self, start: str, goal: str) -> int:
        """Fewest lift-offs and touchdowns on a way from one stratum to another.

        Raises:
            StratumError: A stratum is unknown, or the graph does not join the two.
        """
        for name in (start, goal):
            require_known(f"stratum {name!r}", name, self.strata, StratumError)
        if (start, goal) not in self.switch_counts:
            raise StratumError(message("apart", start=start, goal=goal))
        return self.switch_counts[start, goal]

    @cached_property
    def switch_counts(self) -> dict[tuple[str, str], int]:
        """Fewest lift-offs and touchdowns between strata that the graph joins.

        On an edge of the graph, every contact that only one of its strata has is made
        or broken once.
        """
        counts = {(name, name): 0 for name in self.strata}
        for low, high in self.edges:
            broken = len(self.contacts[low] - self.contacts[high])
            counts[low, high] = counts[high, low] = broken
        for by, a in product(self.strata, repeat=2):  # Floyd and Warshall's method
            tick()
            for b in self.strata if (a, by) in counts else ():
                if (by, b) in counts:
                    through = counts[a, by] + counts[by, b]
                    counts[a, b] = min(through, counts.get((a, b), through))
        return counts

    def _require_tangent_fields(self, stratum: str) -> None:
        level_set = self.level_set(stratum)
        if not level_set.functions:
            return
        if level_set.differential.free_symbols:
            _ = level_set.points  # refuses a curved set that is not regular
        for name, vector_field in self.strata[stratum].items():
            rates = abs(level_set.rates(vector_field))
            if rates.any():
                where, which = divmod(int(rates.argmax()), rates.shape[1])
                place, function = level_set.points[where], level_set.functions[which]
                facts = {"function": function, "place": point(place)}
                raise ValueError(message("leaves", name=name, stratum=stratum, **facts))
