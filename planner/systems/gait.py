"""Gaits: closed walks in the graph of strata, eq. (11)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from planner.errors import StratumError, unknown
from planner.systems.strata import StratifiedSystem


@dataclass(frozen=True, eq=False)
class Gait:
    """A closed walk in the graph of strata, eq. (11).

    Attributes:
        system: System whose strata it visits.
        strata: Names of the strata in order; the first and the last are the same.

    Raises:
        StratumError: The sequence is not a closed walk in the graph.
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
    """Pairs of consecutive strata of a walk."""
    return zip(walk, walk[1:], strict=False)
