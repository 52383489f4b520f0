"""Regroup flows by stratum, with the fewest contact switches (Sec. 5.2).

Two flows are interchanged only if their fields commute. Where a segment may follow one
of several words, such as those of backward and of forward Hall coordinates, the words
are chosen that switch contacts least over the whole plan. Durations do not matter. That
lift fields commute with flows is checked in `extension.fields_on_bottom`. It is never
worse to stay on a stratum until no further flow can run there.
"""

import heapq
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain, groupby, product
from operator import itemgetter

from planner.support.stopping import tick
from planner.systems.flows import Flow, Gait, Word, places_in
from planner.systems.strata import StratifiedSystem

Pattern = tuple[str, ...]  # the fields of a word
Joined = tuple[Pattern, Pattern, tuple[int, ...], list[tuple[int, list[int]]]]
"""Strata and fields of flows, the first place of each, and the others of some."""
Costs = tuple[tuple[str, int], ...]  # switches to each stratum, beyond the cheapest
_flow = partial(tuple.__new__, Flow)  # a third of the time of calling it


@dataclass(frozen=True, slots=True)
class Arrangement:
    """One order of the flows of a pattern."""

    order: tuple[int, ...]  # indices of the flows in time order
    end: str  # stratum of the last flow; the one before an empty pattern
    switches: int  # contact switches from the stratum before the pattern to `end`


Links = dict[str, tuple[str, int, Arrangement]]  # whence, by which word, how


@dataclass(frozen=True, eq=False)
class Grouper:
    """Finds the best arrangements of patterns, flows that commute interchanged."""

    system: StratifiedSystem
    commute: Callable[[str, str], bool]
    _known: dict[tuple[Pattern, str], tuple[Arrangement, ...]] = field(
        default_factory=dict, init=False, repr=False
    )
    _joined: dict[tuple[Pattern, tuple[int, ...]], Joined] = field(
        default_factory=dict, init=False, repr=False
    )

    def arrangements(self, pattern: Pattern, start: str) -> tuple[Arrangement, ...]:
        """The arrangement with fewest contact switches for each stratum to end in.

        A stratum that is left out is reached as cheaply from those listed.
        """
        if not pattern:
            return (Arrangement((), start, 0),)
        if (pattern, start) not in self._known:
            strata = [self.system.stratum_of[name] for name in pattern]
            after = self.prerequisites(pattern)
            ends = dict.fromkeys(strata)
            found = [self._cheapest(strata, after, start, end) for end in ends]
            self._known[pattern, start] = tuple(
                Arrangement(_late(strata, after, order), end, switches)
                for switches, order, end in sorted(filter(None, found))
            )
        return self._known[pattern, start]

    def _cheapest(
        self, strata: Sequence[str], after: Sequence[int], start: str, end: str
    ) -> tuple[int, tuple[int, ...], str] | None:
        """The contact switches and the order of the flows that end on a stratum, by A*.

        A node is the set of flows done and the stratum. The stratum to end in comes
        third; None if no arrangement ends there.
        """
        queue: list[tuple[int, tuple[int, ...], int, int, str]] = [(0, (), 0, 0, start)]
        settled: set[tuple[int, str]] = set()
        counts = self.system.switch_counts
        while queue:
            _, order, switches, done, here = heapq.heappop(queue)
            if len(order) == len(strata):
                return switches, order, end
            if (done, here) in settled:
                continue
            settled.add((done, here))
            for there in _open(strata, done):
                run, then = run_on(strata, after, done, there)
                rest = _open(strata, then)
                early = rest and end not in rest  # no flow would be left to end with
                if run and (here, there) in counts and not early:
                    spent = switches + counts[here, there]
                    least = spent + self._least(there, rest, end)
                    heapq.heappush(queue, (least, order + run, spent, then, there))
        return None

    def _least(self, here: str, rest: Collection[str], end: str) -> int:
        """A lower bound on the contact switches through remaining strata to the end.

        A contact that differs from its present state on some remaining stratum switches
        once, and twice if at the end it is in its present state again.
        """
        contacts = self.system.contacts
        changing = frozenset[str]().union(*(contacts[here] ^ contacts[s] for s in rest))
        return 2 * len(changing) - len(contacts[here] ^ contacts[end])

    def prerequisites(self, pattern: Pattern) -> tuple[int, ...]:
        """For each flow the bit mask of the earlier flows that must precede it."""
        return tuple(
            sum(
                1 << i
                for i, other in enumerate(pattern[:j])
                if other != name and not self.commute(other, name)
            )
            for j, name in enumerate(pattern)
        )

    def flows(self, word: Word, order: tuple[int, ...]) -> list[Flow]:
        """The flows of a word in a given order, joined where fields allow it."""
        key = (word.fields, order)
        if key not in self._joined:
            self._joined[key] = self._join(*key)
        strata, names, firsts, joined = self._joined[key]
        durations = word.durations
        found = [durations[k] for k in firsts]
        for place, others in joined:
            for k in others:
                found[place] += durations[k]
        flows = list(map(_flow, zip(strata, names, found, strict=True)))
        return flows if all(found) else [flow for flow in flows if flow.duration]

    def _join(self, pattern: Pattern, order: tuple[int, ...]) -> Joined:
        """Which flows of a pattern become one flow, in a given order.

        A flow joins the last one along its field if those since then are on the same
        stratum and commute with it.
        """
        stratum, joined = self.system.stratum_of, list[list[int]]()
        for k in order:
            name, here = pattern[k], list[int]()
            for places in reversed(joined):
                other = pattern[places[0]]
                if other == name:
                    here = places
                    break
                if stratum[other] != stratum[name] or not self.commute(other, name):
                    break
            if not here:
                joined.append(here)
            here.append(k)
        firsts = tuple(places[0] for places in joined)
        names = tuple(pattern[k] for k in firsts)
        several = [(i, places[1:]) for i, places in enumerate(joined) if places[1:]]
        return tuple(stratum[name] for name in names), names, firsts, several


def _open(strata: Sequence[str], done: int) -> dict[str, None]:
    """Strata on which flows remain, in order of appearance."""
    return dict.fromkeys(s for j, s in enumerate(strata) if not done >> j & 1)


def run_on(
    strata: Sequence[str], after: Sequence[int], done: int, stratum: str
) -> tuple[tuple[int, ...], int]:
    """All flows that can run on a stratum now, and the mask of flows then done."""
    run: list[int] = []
    for j, where in enumerate(strata):  # one pass: prerequisites come earlier
        if where == stratum and not done >> j & 1 and after[j] & ~done == 0:
            run.append(j)
            done |= 1 << j
    return tuple(run), done


def _late(
    strata: Sequence[str], after: Sequence[int], order: Sequence[int]
) -> tuple[int, ...]:
    """The same visits with every flow as late as possible, as the paper orders them."""
    walk = [stratum for stratum, _ in groupby(strata[i] for i in order)]
    waiting = set(order)
    late: list[int] = []
    for stratum in reversed(walk):
        tick()
        here = (j for j in sorted(waiting, reverse=True) if strata[j] == stratum)
        for j in here:  # one pass: successors come later
            if not any(after[k] >> j & 1 for k in waiting):
                late.append(j)
                waiting.remove(j)
    return tuple(reversed(late))


def regroup(
    grouper: Grouper, segments: Sequence[Sequence[Word]], start: str, goal: str
) -> list[list[Flow]]:
    """Choose a word for each segment and the order of its flows (Sec. 5.2).

    Dynamic programming over the segments finds the fewest contact switches from the
    stratum before the first flow to the one after the last.
    """
    best: Costs = ((start, 0),)
    back: list[Links] = []
    known: dict[tuple[tuple[Pattern, ...], Costs], tuple[Costs, Links]] = {}
    for ways in segments:
        tick()
        key = tuple([way.fields for way in ways]), best
        if key not in known:
            known[key] = _onward(grouper, *key)
        best, links = known[key]
        back.append(links)
    switches = grouper.system.switches
    end, _ = min(best, key=lambda each: each[1] + switches(each[0], goal))
    chosen = []
    for ways, links in zip(reversed(segments), reversed(back), strict=True):
        end, k, found = links[end]
        chosen.append(grouper.flows(ways[k], found.order))
    return chosen[::-1]


def _onward(
    grouper: Grouper, patterns: Sequence[Pattern], best: Costs
) -> tuple[Costs, Links]:
    """The fewest switches to each stratum after one more segment, and how.

    They are counted from the cheapest on, so that alike segments come out alike.
    """
    reached: dict[str, int] = {}
    links: Links = {}
    for here, cost in best:
        for k, pattern in enumerate(patterns):
            for found in grouper.arrangements(pattern, here):
                total = cost + found.switches
                if total < reached.get(found.end, total + 1):
                    reached[found.end] = total
                    links[found.end] = (here, k, found)
    if not reached:  # name two strata that the graph does not join
        for (here, _), name in product(best, chain(*patterns)):
            grouper.system.switches(here, grouper.system.stratum_of[name])
    least = min(reached.values())
    return tuple((end, total - least) for end, total in reached.items()), links


def regroup_in_gait(
    grouper: Grouper, segments: Sequence[Sequence[Word]], gait: Sequence[str], at: str
) -> list[list[Flow]]:
    """Flows of each segment in the order of a gait, with the fewest steps of it.

    Each segment has words to choose from; `at` is the stratum before the first flow.
    """
    cycle = Gait(grouper.system, tuple(gait)).once_around
    plans = []
    for place in places_in(cycle, at):
        ordered: list[list[Flow]] = []
        for ways in segments:
            found = [(*_ordered(grouper, w.fields, cycle, place), w) for w in ways]
            place, order, way = min(found, key=itemgetter(0))
            ordered.append(grouper.flows(way, order))
        plans.append((place, ordered))
    return min(plans, key=itemgetter(0))[1]


def _ordered(
    grouper: Grouper, pattern: tuple[str, ...], cycle: Sequence[str], place: int
) -> tuple[int, tuple[int, ...]]:
    """The place after the last flow of a pattern, and the order of its flows."""
    strata = [grouper.system.stratum_of[name] for name in pattern]
    for stratum in strata:
        places_in(cycle, stratum)  # refuses what the gait never visits
    after = grouper.prerequisites(pattern)
    order: tuple[int, ...] = ()
    done = 0
    while len(order) < len(pattern):
        run, done = run_on(strata, after, done, cycle[place % len(cycle)])
        order += run
        place += len(order) < len(pattern)
    return place, order
