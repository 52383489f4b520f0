"""Flows along the fields of strata in time order, eq. (2), and gaits, eq. (11).

Every flow names its stratum, so flows that lift feet and set them down are never
listed: they are implied wherever the stratum changes. `planning.rollouts` composes
flows as eq. (12) does; the series of eq. (2) is `lie.tensor.Tensor.exp`. A gait is a
closed walk in the graph of strata, possibly through some on which nothing flows.
"""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, pairwise, zip_longest
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from planner.errors import StratumError, message, require_known
from planner.numerics.arrays import Array
from planner.numerics.collocation import STEP_NODES, follow, follow_all
from planner.support.stopping import tick
from planner.systems.formulas import HUGE
from planner.systems.strata import StratifiedSystem

MOST_VISITS = 1000  # of a gait to its strata


class Flow(NamedTuple):
    """The flow phi_t^g along one field of one stratum for a signed time, eq. (2).

    Example:
        >>> from planner import Flow
        >>> print(Flow("0", "f", 0.5))
        S0: +0.5 f
    """

    stratum: str
    field: str
    duration: float

    def __str__(self) -> str:
        return f"S{self.stratum}: {self.duration:+.6g} {self.field}"


class Word(NamedTuple):
    """The flows of a segment in time order, before they are grouped by stratum."""

    fields: tuple[str, ...]  # one tuple for all segments whose words have the same
    durations: Sequence[float]  # signed, of the flow along each field


def require_flows(system: StratifiedSystem, flows: Sequence[Flow]) -> None:
    """Raise `ValueError` unless flows are finite and name strata and fields."""
    for stratum, field in dict.fromkeys(map(itemgetter(0, 1), flows)):
        require_known(f"flow on stratum {stratum!r}, which", stratum, system.strata)
        require_known(f"field {field}", field, system.fields)
        if (owner := system.stratum_of[field]) != stratum:
            facts = {"field": field, "stratum": stratum, "owner": owner}
            raise ValueError(message("foreign_flow", **facts))
    if not all(map(HUGE.__gt__, map(abs, map(itemgetter(2), flows)))):
        flow = next(flow for flow in flows if not abs(flow.duration) < HUGE)
        raise ValueError(f"the duration of flow {flow} is not below {HUGE:g}")


def merged(flows: Iterable[Flow]) -> tuple[Flow, ...]:
    """Join consecutive flows along one field, and drop those that cancel."""
    return tuple(flow for _, flow in merged_segments([flows]))


def merged_segments(
    segments: Iterable[Iterable[Flow]], first: int = 0
) -> list[tuple[int, Flow]]:
    """Merged flows with their segments, which are numbered from the first one on.

    A flow that continues in the next segment belongs to the segment it starts in.
    """
    done: list[tuple[int, Flow]] = []
    for number, flows in enumerate(segments, start=first):
        for flow in flows:
            begun = number
            if done and done[-1][1][:2] == flow[:2]:
                begun, before = done.pop()
                flow = flow._replace(duration=before.duration + flow.duration)
            if flow.duration:
                done.append((begun, flow))
    return done


def visits(flows: Iterable[Flow]) -> list[list[Flow]]:
    """Split a sequence of flows where the stratum changes."""
    return [list(run) for _, run in groupby(flows, itemgetter(0))]


def contact_switches(
    system: StratifiedSystem,
    flows: Iterable[Flow],
    start: str = "",
    goal: str = "",
    gait: Sequence[str] = (),
) -> int:
    """Number of lift-offs and touchdowns that a sequence of flows implies, eq. (12).

    The first lift-off and the final touchdown are included. Start and goal are strata,
    the bottom one if empty. The shortest way in the system's graph joins two
    strata; a gait is followed through strata without flows, too.

    Example:
        >>> from planner import EXAMPLES, Flow, contact_switches
        >>> contact_switches(EXAMPLES["walker"], [Flow("1", "f", 1), Flow("2", "g", 1)])
        4
    """
    ends = start or system.bottom, goal or system.bottom
    walk = [run[0].stratum for run in visits(merged(flows))] + [ends[1]]
    if gait:
        walk = [*chain(*gait_steps(system, flows, gait, ends))]
    return sum(system.switches(a, b) for a, b in pairwise([ends[0], *walk]))


def flow_map(
    system: StratifiedSystem, name: str, x: Sequence[float] | Array, duration: float
) -> Array:
    """The configuration phi_t^g(x) after a flow along a field, eq. (2), shape (n,).

    The field g has a name, x has shape (n,), and the duration t a sign.

    Raises:
        ValueError: The system has no such field.
        ConvergenceError: The flow escapes to infinity, or the field is not smooth.

    Example:
        >>> from planner import EXAMPLES, flow_map
        >>> flow_map(EXAMPLES["heisenberg"], "g", (1, 0, 0), 2.0)
        array([1., 2., 2.])
    """
    field, start = system.compiled(name), np.asarray(x, dtype=float)
    if start.shape != (size := system.dimension,):
        raise ValueError(f"x has shape {start.shape}; give {size} coordinates")
    if field.is_constant:
        end = start + duration * field.constant[:, 0]
        if np.isfinite(end).all():
            return end
    return follow(field.velocity, start, duration)


def word_ends(
    system: StratifiedSystem, words: Sequence[Word], at: Array, nodes: int = STEP_NODES
) -> Array:
    """Where words end, each from its start, shape (words, n); nan where they escape.

    All that are about to follow one field of a changing velocity do so at once.
    """
    ends, alike = at.copy(), dict[tuple[str, ...], list[int]]()
    for i, word in enumerate(words):
        alike.setdefault(word.fields, []).append(i)
    parts = [_stops(system, words, rows, ends) for rows in alike.values()]
    for found in zip_longest(*parts):
        stops = [stop for stop in found if stop]
        for field in {field for field, *_ in stops}:
            together = [(rows, times) for other, rows, times in stops if other == field]
            rows, times = map(np.concatenate, zip(*together, strict=True))
            velocity = system.compiled(field).velocity
            ends[rows] = follow_all(velocity, ends[rows], times, nodes)
    return ends


def _stops(
    system: StratifiedSystem, words: Sequence[Word], rows: list[int], ends: Array
) -> Iterator[tuple[str, list[int], Array]]:
    """Flows of words of the same fields; where velocities are constant, follow."""
    durations = np.array([words[i].durations for i in rows])
    for name, times in zip(words[rows[0]].fields, durations.T, strict=True):
        field = system.compiled(name)
        if field.is_constant:
            ends[rows] += times[:, None] * field.constant[:, 0]
        else:
            yield name, rows, times


@dataclass(frozen=True, eq=False)
class Gait:
    """A closed walk in the graph of strata, eq. (11).

    Attributes:
        system: System whose strata it visits.
        strata: Names of the strata in order, with the S of the paper or without; the
            first and the last are the same.

    Raises:
        StratumError: The sequence is not a closed walk in the graph.

    Example:
        >>> from planner import EXAMPLES, Gait
        >>> print(Gait(EXAMPLES["walker"], ("12", "1", "12", "2", "12")))
        S12 -> S1 -> S12 -> S2 -> S12
    """

    system: StratifiedSystem
    strata: tuple[str, ...]

    def __post_init__(self) -> None:
        known = self.system.strata
        bare = (s if s in known else str(s).removeprefix("S") for s in self.strata)
        object.__setattr__(self, "strata", tuple(bare))
        if not 0 < (count := len(self.strata)) <= MOST_VISITS:
            visits = f"a gait visits 1 to {MOST_VISITS} strata, got {count or 'none'}"
            raise StratumError(f"{visits} (eq. 11)")
        for name in self.strata:
            require_known(f"stratum {name!r} of gait {self}", name, known, StratumError)
        if self.strata[0] != self.strata[-1]:
            ends = {"first": self.strata[0], "last": self.strata[-1]}
            raise StratumError(message("open", gait=self, **ends))
        for a, b in pairwise(self.strata):
            if b not in (a, *self.system.neighbours[a]):
                near = ", ".join(f"S{s}" for s in self.system.neighbours[a]) or "none"
                step = {"here": a, "there": b, "near": near}
                raise StratumError(message("steps", gait=self, **step))

    def __str__(self) -> str:
        return " -> ".join(f"S{name}" for name in self.strata)

    @property
    def once_around(self) -> tuple[str, ...]:
        """The strata without the last, which is the first again."""
        return self.strata[:-1] or self.strata


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
    known = {stratum: places_in(cycle, stratum) for stratum in dict.fromkeys(wanted)}
    walks = []
    for at in places_in(cycle, ends[0]):
        tick()
        places = [at]
        for stratum in wanted:
            rounds, last = divmod(places[-1], len(cycle))
            ahead = bisect_left(own := known[stratum], last)
            more, ahead = divmod(ahead, len(own))
            places.append((rounds + more) * len(cycle) + own[ahead])
        walks.append(places)
    places = min(walks, key=lambda walk: walk[-1] - walk[0])
    return tuple(
        tuple(cycle[i % len(cycle)] for i in range(before + 1, after + 1))
        for before, after in pairwise(places)
    )


def places_in(cycle: Sequence[str], stratum: str) -> list[int]:
    """Places of a stratum in a gait; `StratumError` if there is none."""
    if stratum not in cycle:
        raise StratumError(message("unvisited", cycle=" ".join(cycle), stratum=stratum))
    return [i for i, name in enumerate(cycle) if name == stratum]
