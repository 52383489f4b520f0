"""Regroup flows by stratum with the fewest contact switches (Sec. 5.2).

Flows are interchanged only if their fields commute. Each segment may be run in several
ways, such as in backward or in forward Hall coordinates; the choice that switches least
over the whole plan is taken. Durations play no part here.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, groupby

from planner.systems.flows import Flow, Word
from planner.systems.strata import StratifiedSystem

Commute = Callable[[str, str], bool]
Pattern = tuple[str, ...]  # the fields of a word
Joint = tuple[str, str, tuple[int, ...]]  # stratum, field, places of the joined flows


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
    """Finds and remembers the best arrangements of words by their patterns.

    Attributes:
        system: System whose graph of strata prices a change of stratum.
        commute: Whether two fields' flows may be interchanged.
    """

    system: StratifiedSystem
    commute: Commute
    _known: dict[tuple[Pattern, str], tuple[Arrangement, ...]] = field(
        default_factory=dict, init=False, repr=False
    )
    _joints: dict[tuple[Pattern, tuple[int, ...]], tuple[Joint, ...]] = field(
        default_factory=dict, init=False, repr=False
    )

    @cached_property
    def price(self) -> Mapping[tuple[str, str], int]:
        """Contact events between any two strata that the graph joins."""
        walks = self.system.walks
        return {(a, b): self.system.switches(a, b) for a in walks for b in walks[a]}

    def arrangements(self, pattern: Pattern, start: str) -> tuple[Arrangement, ...]:
        """The cheapest arrangement for each stratum that is worth ending in.

        Staying on until nothing more can run never costs; a stratum left out is reached
        as cheaply by going on to it.
        """
        key = (pattern, start)
        if key not in self._known:
            self._known[key] = self._search(pattern, start)
        return self._known[key]

    def _search(self, pattern: Pattern, start: str) -> tuple[Arrangement, ...]:
        """One search for each stratum to end in; the cheapest arrangement first."""
        if not pattern:
            return (Arrangement((), start, 0),)
        strata = [self.system.stratum_of[name] for name in pattern]
        after = self._prerequisites(pattern)
        ends = dict.fromkeys(strata)
        found = [self._cheapest(strata, after, start, end) for end in ends]
        return tuple(
            Arrangement(_late(strata, after, order), end, switches)
            for switches, order, end in sorted(filter(None, found))
        )

    def _cheapest(
        self, strata: Sequence[str], after: Sequence[int], start: str, end: str
    ) -> tuple[int, tuple[int, ...], str] | None:
        """A* over the flows done and the stratum; staying on never costs.

        Returns:
            Switches, the flows in order and the end; None where the end is not last.
        """
        queue: list[tuple[int, tuple[int, ...], int, int, str]] = [(0, (), 0, 0, start)]
        settled: set[tuple[int, str]] = set()
        while queue:
            _, order, switches, done, here = heapq.heappop(queue)
            if len(order) == len(strata):
                return switches, order, end
            if (done, here) in settled:
                continue
            settled.add((done, here))
            for there in _open(strata, done):
                run, then = _run(strata, after, done, there)
                rest = _open(strata, then)
                early = rest and end not in rest  # nothing would be left to end with
                if run and (here, there) in self.price and not early:
                    spent = switches + self.price[here, there]
                    least = spent + self._least(there, rest, end)
                    heapq.heappush(queue, (least, order + run, spent, then, there))
        return None

    def _least(self, here: str, rest: Collection[str], end: str) -> int:
        """Contact events that a walk through the strata left, to the end, must have.

        A contact that is not always as it is here changes, and twice to be so at last.
        """
        contacts = self.system.contacts
        changing = frozenset[str]().union(*(contacts[here] ^ contacts[s] for s in rest))
        return 2 * len(changing) - len(contacts[here] ^ contacts[end])

    def _prerequisites(self, pattern: Pattern) -> tuple[int, ...]:
        """For each flow the bit mask of earlier flows it must not overtake."""
        return tuple(
            sum(1 << i for i in range(j) if not self.interchange(pattern[i], name))
            for j, name in enumerate(pattern)
        )

    def interchange(self, a: str, b: str) -> bool:
        """Whether flows along two fields may trade places."""
        return a == b or self.commute(a, b)

    def flows(self, word: Word, order: tuple[int, ...]) -> list[Flow]:
        """A word as flows in a given order, those of one field and visit joined."""
        key = (word.fields, order)
        if key not in self._joints:
            self._joints[key] = self._joined(*key)
        flows = [
            Flow(stratum, name, sum([word.durations[k] for k in joint]))
            for stratum, name, joint in self._joints[key]
        ]
        return [flow for flow in flows if flow.duration]

    def _joined(self, pattern: Pattern, order: tuple[int, ...]) -> tuple[Joint, ...]:
        """Which of a pattern's flows become one, in a given order."""
        joints: list[list[int]] = []
        for k in order:
            fields = [pattern[joint[0]] for joint in joints]
            i = self._partner(fields, pattern[k])
            if i is None:
                joints.append([k])
            else:
                joints[i].append(k)
        names = [pattern[joint[0]] for joint in joints]
        strata = [self.system.stratum_of[name] for name in names]
        return tuple(zip(strata, names, map(tuple, joints), strict=True))

    def _partner(self, fields: Sequence[str], name: str) -> int | None:
        """An earlier flow of the field, if only commuting ones of its visit follow."""
        stratum_of = self.system.stratum_of
        for i, other in reversed(list(enumerate(fields))):
            if other == name:
                return i
            if stratum_of[other] != stratum_of[name] or not self.commute(other, name):
                return None
        return None


def _open(strata: Sequence[str], done: int) -> dict[str, None]:
    """Strata with flows still to run, in order of appearance."""
    return dict.fromkeys(s for j, s in enumerate(strata) if not done >> j & 1)


def _run(
    strata: Sequence[str], after: Sequence[int], done: int, stratum: str
) -> tuple[tuple[int, ...], int]:
    """Everything that can run on one stratum now, and the mask of what is done then."""
    run: list[int] = []
    for j, where in enumerate(strata):  # one pass: prerequisites come earlier
        if where == stratum and not done >> j & 1 and after[j] & ~done == 0:
            run.append(j)
            done |= 1 << j
    return tuple(run), done


def _late(
    strata: Sequence[str], after: Sequence[int], order: Sequence[int]
) -> tuple[int, ...]:
    """The same visits with every flow as late as it can be, the paper's order."""
    walk = [stratum for stratum, _ in groupby(strata[i] for i in order)]
    waiting = set(order)
    late: list[int] = []
    for stratum in reversed(walk):
        for j in sorted(waiting, reverse=True):  # one pass: what follows comes later
            free = not any(after[k] >> j & 1 for k in waiting if k != j)
            if strata[j] == stratum and free:
                late.append(j)
                waiting.remove(j)
    return tuple(reversed(late))


def regroup(
    grouper: Grouper, segments: Sequence[Sequence[Word]], start: str, goal: str
) -> list[list[Flow]]:
    """Choose one way to run each segment and its order, with the fewest switches.

    Args:
        grouper: What commutes, and what a change of stratum costs.
        segments: For each segment the ways to run it, each a word.
        start: Stratum at rest before the first flow.
        goal: Stratum at rest after the last one.

    Returns:
        For each segment its flows in time order.
    """
    system = grouper.system
    best: dict[str, int] = {start: 0}  # fewest switches on the way to each stratum
    back: list[dict[str, tuple[str, int, Arrangement]]] = []
    for ways in segments:
        patterns = [way.fields for way in ways]
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
        chosen.append(grouper.flows(ways[k], found.order))
    return chosen[::-1]


def _refuse(
    system: StratifiedSystem, starts: Iterable[str], patterns: Iterable[Pattern]
) -> None:
    """Name the strata that the graph does not join."""
    for start in starts:
        for name in chain(*patterns):
            system.route(start, system.stratum_of[name])
