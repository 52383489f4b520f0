"""Gaits: closed walks in the graph of strata, eq. (11), and flows in their order.

Between two flows a walk follows the gait, possibly through strata on which nothing
flows, until it reaches the stratum of the next flow. It is never worse to stay on a
stratum until no further flow can run there, so the gait moves on only when it must.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter

from planner.errors import StratumError, require_known
from planner.systems.flows import Flow, Word
from planner.systems.grouping import Grouper, run_on
from planner.systems.strata import StratifiedSystem


@dataclass(frozen=True, eq=False)
class Gait:
    """A closed walk in the graph of strata, eq. (11).

    Attributes:
        system: System whose strata it visits.
        strata: Names of the strata in order; the first and the last are the same.

    Raises:
        StratumError: The sequence is not a closed walk in the graph.

    Example:
        >>> from planner import Gait, StratifiedSystem
        >>> fields = {"12": {}, "1": {"f": [1, 0, 0]}, "2": {"g": [0, 1, "x"]}}
        >>> walker = StratifiedSystem("x y z", fields, "12")
        >>> print(Gait(walker, ("12", "1", "12", "2", "12")))
        S12 -> S1 -> S12 -> S2 -> S12
    """

    system: StratifiedSystem
    strata: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "strata", tuple(self.strata))
        if not self.strata:
            raise StratumError("a gait visits at least one stratum, got none (eq. 11)")
        for name in self.strata:
            what = f"stratum {name!r} of gait {self}"
            require_known(what, name, self.system.strata, StratumError)
        if self.strata[0] != self.strata[-1]:
            raise StratumError(
                f"gait {self} does not close: it starts in S{self.strata[0]} and "
                f"ends in S{self.strata[-1]}; end it in S{self.strata[0]} (eq. 11)"
            )
        for a, b in pairwise(self.strata):
            if b not in (a, *self.system.neighbours[a]):
                near = ", ".join(f"S{s}" for s in self.system.neighbours[a]) or "none"
                raise StratumError(
                    f"gait {self} steps from S{a} to S{b}, which are not neighbours; "
                    f"the neighbours of S{a}: {near} (Fig. 3)"
                )

    def __str__(self) -> str:
        return " -> ".join(f"S{name}" for name in self.strata)

    @property
    def once_around(self) -> tuple[str, ...]:
        """The strata without the last, which is the first again."""
        return self.strata[:-1] or self.strata


def regroup_in_gait(
    grouper: Grouper,
    segments: Sequence[Sequence[Word]],
    gait: Sequence[str],
    start: str,
) -> list[list[Flow]]:
    """Flows of each segment in the order of a gait, with the fewest steps of it.

    Each segment has words to choose from; `start` is the stratum before the first flow.
    """
    cycle = Gait(grouper.system, tuple(gait)).once_around
    plans = []
    for place in _places(cycle, start):
        ordered: list[list[Flow]] = []
        for ways in segments:
            found = [
                (*_ordered(grouper, way.fields, cycle, place), way) for way in ways
            ]
            place, order, way = min(found, key=itemgetter(0))
            ordered.append(grouper.flows(way, order))
        plans.append((place, ordered))
    return min(plans, key=itemgetter(0))[1]


def gait_steps(
    system: StratifiedSystem,
    flows: Iterable[Flow],
    gait: Sequence[str],
    ends: tuple[str, str],
) -> tuple[tuple[str, ...], ...]:
    """Strata entered before each flow along a closed walk, and after the last flow.

    `ends` are the strata before the first flow and after the last one.
    """
    cycle = Gait(system, tuple(gait)).once_around
    wanted = [*(flow.stratum for flow in flows), ends[1]]
    walks = []
    for at in _places(cycle, ends[0]):
        places = [at]
        for stratum in wanted:
            last = places[-1]
            ahead = [(at - last) % len(cycle) for at in _places(cycle, stratum)]
            places.append(last + min(ahead))
        walks.append(places)
    places = min(walks, key=lambda walk: walk[-1] - walk[0])
    return tuple(
        tuple(cycle[i % len(cycle)] for i in range(before + 1, after + 1))
        for before, after in pairwise(places)
    )


def walk_switches(system: StratifiedSystem, walk: Sequence[str]) -> int:
    """Number of lift-offs and touchdowns of a walk through strata."""
    contacts = system.contacts
    return sum(len(contacts[a] ^ contacts[b]) for a, b in pairwise(walk))


def _places(cycle: Sequence[str], stratum: str) -> list[int]:
    if stratum not in cycle:
        raise StratumError(
            f"the gait {' '.join(cycle)} does not visit S{stratum}, which is needed; "
            "add it"
        )
    return [i for i, name in enumerate(cycle) if name == stratum]


def _ordered(
    grouper: Grouper, pattern: tuple[str, ...], cycle: Sequence[str], place: int
) -> tuple[int, tuple[int, ...]]:
    """The place after the last flow of a pattern, and the order of its flows."""
    strata = [grouper.system.stratum_of[name] for name in pattern]
    for stratum in strata:
        _places(cycle, stratum)  # refuses what the gait never visits
    after = grouper.prerequisites(pattern)
    order: tuple[int, ...] = ()
    done = 0
    while len(order) < len(pattern):
        run, done = run_on(strata, after, done, cycle[place % len(cycle)])
        order += run
        place += len(order) < len(pattern)
    return place, order
