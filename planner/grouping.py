"""Regroup flows by stratum with the fewest contact switches (Sec. 5.2).

Flows are interchanged only if their fields commute. Each segment may be run in several
ways, such as in backward or in forward Hall coordinates; the choice that switches least
over the whole plan is taken. Durations play no part here.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, groupby

from planner.flows import Flow
from planner.strata import StratifiedSystem

Commute = Callable[[str, str], bool]
Pattern = tuple[tuple[str, str], ...]  # strata and fields of a segment's flows


@dataclass(frozen=True, slots=True)
class Arrangement:
    """One order of a pattern's flows.

    Attributes:
        order: Indices of the flows in the order to run them.
        end: Stratum of the last flow; the one before the pattern if it is empty.
        switches: Contact events from the stratum before to the last one.
    """

    order: tuple[int, ...]
    end: str
    switches: int


@dataclass(frozen=True, eq=False)
class Grouper:
    """Finds and remembers the best arrangements of patterns.

    Attributes:
        system: System whose graph of strata prices a change of stratum.
        commute: Whether two fields' flows may be interchanged.
    """

    system: StratifiedSystem
    commute: Commute
    _known: dict[tuple[Pattern, str], tuple[Arrangement, ...]] = field(
        default_factory=dict
    )

    @cached_property
    def price(self) -> Mapping[tuple[str, str], int]:
        """Contact events between any two strata that the graph joins."""
        walks = self.system.walks
        return {(a, b): self.system.switches(a, b) for a in walks for b in walks[a]}

    def arrangements(self, pattern: Pattern, start: str) -> tuple[Arrangement, ...]:
        """For each stratum the pattern can end in, its cheapest arrangement."""
        key = (pattern, start)
        if key not in self._known:
            self._known[key] = tuple(self._search(pattern, start))
        return self._known[key]

    def _search(self, pattern: Pattern, start: str) -> Iterable[Arrangement]:
        """Dijkstra over the flows done and the stratum; staying on never costs."""
        after = self._prerequisites(pattern)
        everything = (1 << len(pattern)) - 1
        queue: list[tuple[int, tuple[int, ...], int, str]] = [(0, (), 0, start)]
        settled: set[tuple[int, str]] = set()
        while queue:
            switches, order, done, here = heapq.heappop(queue)
            if (done, here) in settled:
                continue
            settled.add((done, here))
            if done == everything:
                yield Arrangement(_late(pattern, after, order), here, switches)
                continue
            for there in dict.fromkeys(stratum for stratum, _ in pattern):
                run, then = _run(pattern, after, done, there)
                if run and (here, there) in self.price:
                    price = switches + self.price[here, there]
                    heapq.heappush(queue, (price, order + run, then, there))

    def _prerequisites(self, pattern: Pattern) -> tuple[int, ...]:
        """For each flow the bit mask of earlier flows it must not overtake."""
        return tuple(
            sum(1 << i for i in range(j) if not self.interchange(pattern[i][1], name))
            for j, (_, name) in enumerate(pattern)
        )

    def interchange(self, a: str, b: str) -> bool:
        """Whether flows along two fields may trade places."""
        return a == b or self.commute(a, b)


def _run(
    pattern: Pattern, after: Sequence[int], done: int, stratum: str
) -> tuple[tuple[int, ...], int]:
    """Everything that can run on one stratum now, and the mask of what is done then."""
    run: list[int] = []
    for j, (where, _) in enumerate(pattern):  # one pass: prerequisites come earlier
        if where == stratum and not done >> j & 1 and after[j] & ~done == 0:
            run.append(j)
            done |= 1 << j
    return tuple(run), done


def _late(
    pattern: Pattern, after: Sequence[int], order: Sequence[int]
) -> tuple[int, ...]:
    """The same visits with every flow as late as it can be, the paper's order."""
    walk = [stratum for stratum, _ in groupby(pattern[i][0] for i in order)]
    waiting = set(order)
    late: list[int] = []
    for stratum in reversed(walk):
        for j in sorted(waiting, reverse=True):  # one pass: what follows comes later
            free = not any(after[k] >> j & 1 for k in waiting if k != j)
            if pattern[j][0] == stratum and free:
                late.append(j)
                waiting.remove(j)
    return tuple(reversed(late))


def regroup(
    grouper: Grouper,
    segments: Sequence[Sequence[Sequence[Flow]]],
    start: str,
    goal: str,
) -> list[list[Flow]]:
    """Choose one way to run each segment and its order, with the fewest switches.

    Args:
        grouper: What commutes, and what a change of stratum costs.
        segments: For each segment the ways to run it, each a sequence of flows.
        start: Stratum at rest before the first flow.
        goal: Stratum at rest after the last one.

    Returns:
        For each segment its flows in time order.
    """
    system = grouper.system
    best: dict[str, int] = {start: 0}  # fewest switches on the way to each stratum
    back: list[dict[str, tuple[str, int, Arrangement]]] = []
    for ways in segments:
        patterns = [tuple(flow[:2] for flow in way) for way in ways]
        reached: dict[str, int] = {}
        links: dict[str, tuple[str, int, Arrangement]] = {}
        for here, cost in best.items():
            for k, pattern in enumerate(patterns):
                for found in grouper.arrangements(pattern, here):
                    total = cost + found.switches
                    if total < reached.get(found.end, total + 1):
                        reached[found.end] = total
                        links[found.end] = (here, k, found)
        if not reached:
            _refuse(system, best, patterns)
        best = reached
        back.append(links)
    end = min(best, key=lambda stratum: best[stratum] + system.switches(stratum, goal))
    chosen = []
    for ways, links in zip(reversed(segments), reversed(back), strict=True):
        end, k, found = links[end]
        chosen.append(_joined(grouper, [ways[k][i] for i in found.order]))
    return chosen[::-1]


def _refuse(
    system: StratifiedSystem, starts: Iterable[str], patterns: Iterable[Pattern]
) -> None:
    """Name the strata that the graph does not join."""
    for start in starts:
        for stratum, _ in chain(*patterns):
            system.route(start, stratum)


def _joined(grouper: Grouper, flows: Iterable[Flow]) -> list[Flow]:
    """Join flows of one field of a visit that only commuting flows keep apart."""
    joined: list[Flow] = []
    for flow in flows:
        for i in range(len(joined) - 1, -1, -1):
            last = joined[i]
            if last.field == flow.field and last.stratum == flow.stratum:
                joined[i] = flow._replace(duration=last.duration + flow.duration)
                break
            if last.stratum != flow.stratum or not grouper.interchange(
                last.field, flow.field
            ):
                joined.append(flow)
                break
        else:
            joined.append(flow)
    return [flow for flow in joined if flow.duration]
