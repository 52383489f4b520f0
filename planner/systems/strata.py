"""Stratified systems as data: a state, strata with their fields, foot heights (Def. 1).

A stratum's contacts are its level sets; where none are given they are read from its
name, one character a contact and `0` for none, so that S12 is `"12"`. No two strata
have the same. Two are neighbours in the graph of Figs. 2 and 3 when one's contacts
contain the other's and no third stratum lies between. Planning happens elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from heapq import heappop, heappush
from itertools import count

import numpy as np
import sympy as sp

from planner.errors import StratumError, point, unknown
from planner.numerics.arrays import Array
from planner.numerics.subspaces import directions_beyond
from planner.systems.declaration import (
    checked_level_sets,
    checked_state,
    checked_strata,
)
from planner.systems.fields import (
    CompiledFields,
    Symbols,
    VectorField,
    compile_fields,
)
from planner.systems.level_sets import LevelSet


@dataclass(frozen=True, eq=False)
class StratifiedSystem:
    """A driftless system on each of several strata, eq. (10).

    Attributes:
        state: Symbols of the configuration, n of them; names are accepted.
        strata: For each stratum its fields by name: sympy columns of shape (n, 1), or
            functions of a configuration. The order of all fields numbers the
            generators, from 1.
        bottom: Stratum in which plans start and end, S_B.
        level_sets: For each stratum the expressions that are zero on it, such as the
            heights of its feet. Strata without an entry are open.

    Raises:
        ValueError: Anything above is misshapen, unknown, or not tangent to its stratum.
    """

    state: Symbols
    strata: Mapping[str, Mapping[str, VectorField]]
    bottom: str
    level_sets: Mapping[str, tuple[sp.Expr, ...]] = field(default_factory=dict)
    _compiled: dict[str, CompiledFields] = field(
        default_factory=dict, init=False, repr=False
    )

    def __post_init__(self) -> None:
        normalised = checked_state(self.state)
        strata = checked_strata(self.strata, normalised)
        level_sets = checked_level_sets(self.level_sets, strata, normalised)
        if self.bottom not in strata:
            raise ValueError(f"bottom {self.bottom!r} {unknown(self.bottom, strata)}")
        for name, value in (
            ("state", normalised),
            ("strata", strata),
            ("level_sets", level_sets),
        ):
            object.__setattr__(self, name, value)
        self._require_distinct_contacts()
        for stratum in self.strata:
            self._require_tangent_fields(stratum)

    @property
    def dimension(self) -> int:
        """Size n of the state."""
        return len(self.state)

    @cached_property
    def bottom_dimension(self) -> int:
        """Dimension of the bottom stratum: n less the number of its level sets."""
        return self.dimension - len(self.level_set(self.bottom).functions)

    @cached_property
    def fields(self) -> dict[str, VectorField]:
        """Every field by name, in the order that numbers the generators."""
        return {
            name: f for fields in self.strata.values() for name, f in fields.items()
        }

    def compiled(self, name: str) -> CompiledFields:
        """A field as a numeric function, compiled when first asked for.

        Raises:
            ValueError: There is no such field.
        """
        if name not in self._compiled:
            if name not in self.fields:
                raise ValueError(f"field {name} {unknown(name, self.fields)}")
            compiled = compile_fields([self.fields[name]], self.state, [name])
            self._compiled[name] = compiled
        return self._compiled[name]

    @cached_property
    def stratum_of(self) -> dict[str, str]:
        """The stratum on which each field acts."""
        return {name: s for s, fields in self.strata.items() for name in fields}

    @cached_property
    def contacts(self) -> dict[str, frozenset[str]]:
        """Contacts of each stratum: its level sets, or else its name's characters."""
        if self.level_sets:
            return {
                s: frozenset(map(str, self.level_sets.get(s, ()))) for s in self.strata
            }
        return {s: frozenset(s) - {"0"} for s in self.strata}

    def level_set(self, stratum: str) -> LevelSet:
        """The functions that vanish on a stratum; none where it is open."""
        return self._level_sets[stratum]

    @cached_property
    def _level_sets(self) -> dict[str, LevelSet]:
        """One for each stratum, so that each is compiled once."""
        given = self.level_sets
        return {s: LevelSet(given.get(s, ()), self.state) for s in self.strata}

    def missing(self, reached: Array, x: Array, stratum: str = "") -> tuple[str, ...]:
        """Directions of a stratum's tangent space that are not reached, in words.

        Args:
            reached: Orthonormal columns, shape (n, rank).
            x: Configuration on the stratum, shape (n,).
            stratum: The stratum; the bottom one if empty.
        """
        gradients = self.level_set(stratum or self.bottom).gradients(x)
        return directions_beyond(np.hstack([reached, gradients]), self.state)

    @cached_property
    def edges(self) -> tuple[tuple[str, str], ...]:
        """Neighbours (lower, higher) in the graph of strata, Figs. 2 and 3."""
        contacts = self.contacts
        return tuple(
            (low, high)
            for low in self.strata
            for high in self.strata
            if contacts[high] < contacts[low]
            and not any(contacts[high] < c < contacts[low] for c in contacts.values())
        )

    @cached_property
    def neighbours(self) -> dict[str, tuple[str, ...]]:
        """Strata one step away in the graph, those with more contacts first."""
        near: dict[str, list[str]] = {s: [] for s in self.strata}
        for low, high in self.edges:
            near[low].append(high)
            near[high].append(low)
        return {
            s: tuple(sorted(near[s], key=lambda t: -len(self.contacts[t])))
            for s in near
        }

    def route(self, start: str, goal: str) -> tuple[str, ...]:
        """The walk of fewest contact events between strata, then of fewest steps.

        Where walks are alike in both, feet land before others lift.

        Raises:
            StratumError: A stratum is unknown, or the graph does not join the two.
        """
        for name in (start, goal):
            if name not in self.strata:
                raise StratumError(f"stratum {name!r} {unknown(name, self.strata)}")
        if goal not in self.walks[start]:
            raise StratumError(
                f"no chain of nested strata joins S{start} to S{goal}; "
                "add the stratum that has the contacts of both"
            )
        return self.walks[start][goal]

    def switches(self, start: str, goal: str) -> int:
        """Contact events, lifts plus landings, from one stratum to another."""
        route = self.route(start, goal)
        return sum(len(self.contacts[a] ^ self.contacts[b]) for a, b in steps(route))

    @cached_property
    def walks(self) -> dict[str, dict[str, tuple[str, ...]]]:
        """Walks of fewest events from each stratum to those that the graph joins."""
        return {s: self._walks(s) for s in self.strata}

    def _walks(self, start: str) -> dict[str, tuple[str, ...]]:
        """Dijkstra's algorithm; among equal walks the one thought of first."""
        walks: dict[str, tuple[str, ...]] = {}
        thought_of = count()
        alone: tuple[str, ...] = (start,)
        queue = [(0, 1, next(thought_of), alone)]
        while queue:
            events, length, _, walk = heappop(queue)
            here = walk[-1]
            for there in self.neighbours[here] if here not in walks else ():
                more = len(self.contacts[here] ^ self.contacts[there])
                way = (events + more, length + 1, next(thought_of), (*walk, there))
                heappush(queue, way)
            walks.setdefault(here, walk)
        return walks

    def _require_distinct_contacts(self) -> None:
        for name in self.strata if len(self.strata) > 1 else ():
            clear = len(set(name)) == len(name) and ("0" not in name or name == "0")
            if not (clear or self.level_sets):
                raise ValueError(
                    f"stratum {name!r} has a contact for each character of its name, "
                    "0 for none; name every contact once, or give level_sets"
                )
        seen: dict[frozenset[str], str] = {}
        for name, contacts in self.contacts.items():
            if (other := seen.setdefault(contacts, name)) != name:
                raise ValueError(
                    f"strata S{other} and S{name} have the same contacts; make them "
                    "one, or give level_sets that tell them apart"
                )

    def _require_tangent_fields(self, stratum: str) -> None:
        level_set = self.level_set(stratum)
        for name, vector_field in self.strata[stratum].items():
            rates = abs(level_set.rates(vector_field)) if level_set.functions else None
            if rates is not None and rates.any():
                where, which = divmod(int(rates.argmax()), rates.shape[1])
                raise ValueError(
                    f"field {name} leaves its stratum S{stratum}: it changes "
                    f"{level_set.functions[which]} at "
                    f"{point(level_set.points[where])}; a field that lifts a foot "
                    "belongs to the stratum it leads to"
                )


@dataclass(frozen=True, eq=False)
class Gait:
    """A closed walk in the graph of strata, eq. (11).

    Attributes:
        system: System whose strata it visits.
        strata: Names in order; the first and the last are the same.

    Raises:
        StratumError: The sequence is not a closed walk; the message says why.
    """

    system: StratifiedSystem
    strata: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "strata", tuple(self.strata))
        known = self.system.strata
        if not self.strata:
            raise StratumError("a gait visits at least one stratum, got none (eq. 11)")
        for name in self.strata:
            if name not in known:
                raise StratumError(
                    f"stratum {name!r} of gait {self} {unknown(name, known)}"
                )
        if self.strata[0] != self.strata[-1]:
            raise StratumError(
                f"gait {self} does not close: it starts in S{self.strata[0]} and "
                f"ends in S{self.strata[-1]}; end it in S{self.strata[0]} (eq. 11)"
            )
        for a, b in steps(self.strata):
            if b not in (a, *self.system.neighbours[a]):
                near = ", ".join(f"S{s}" for s in self.system.neighbours[a]) or "none"
                raise StratumError(
                    f"gait {self} steps from S{a} to S{b}, which are not neighbours; "
                    f"the neighbours of S{a}: {near} (Fig. 3)"
                )

    def __str__(self) -> str:
        return " -> ".join(f"S{name}" for name in self.strata)


def steps(walk: Sequence[str]) -> Iterable[tuple[str, str]]:
    """Consecutive pairs of a walk."""
    return zip(walk, walk[1:], strict=False)
