"""Centre every stroke on shape zero by means of recoveries.

A stroke is the swing of a loaded leg, a recovery the swing of a leg in the air. A
recovery moves one shape coordinate on which no field depends, so it commutes with all
flows and does not move the body. The recoveries of a plan are therefore replaced by
others, which bring the leg to where its next stroke will be centred on zero.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate, product

from planner.numerics.arrays import Array
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

SHORTEST_RECOVERY = 1e-12  # a recovery shorter than this is a rounding error


@dataclass(frozen=True)
class _Visit:
    """A stay on one stratum: recoveries first, then strokes."""

    stratum: str
    segment: int  # to which its recoveries belong
    recoveries: dict[str, float] = field(default_factory=dict)  # duration by field
    strokes: list[tuple[int, Flow]] = field(default_factory=list)  # with their segment

    @cached_property
    def runs(self) -> list[tuple[str, float]]:
        """Fields of the strokes in turn, each with its whole duration."""
        runs = list[tuple[str, float]]()
        for _, flow in self.strokes:
            before = runs.pop()[1] if runs and runs[-1][0] == flow.field else 0.0
            runs.append((flow.field, before + flow.duration))
        return runs

    def load(self, rates: Mapping[str, float]) -> tuple[float, float] | None:
        """Middle and end of a coordinate's strokes, from their start; None if none."""
        ways = [rates[name] * duration for name, duration in self.runs if rates[name]]
        ends = [*accumulate(ways, initial=0.0)]
        return ((min(ends) + max(ends)) / 2, ends[-1]) if ways else None


def centred(
    shape: ShapeCoordinates,
    segments: Sequence[Sequence[Flow]],
    start: Array,
    goal: Array | None,
    ends: tuple[str, str],
) -> list[list[Flow]]:
    """Flows that move the body as given ones do, with every stroke centred on zero.

    The flows of each segment are grouped by stratum and lead from a configuration (n,)
    to the shape of another, if there is one; `ends` are the strata before and after.
    """
    visits = list[_Visit]()  # some may be left empty
    for k, flows in enumerate(segments):
        for flow in flows:
            if not visits or visits[-1].stratum != flow.stratum:
                visits.append(_Visit(flow.stratum, k))
            if flow.field not in shape.recoveries:
                visits[-1].strokes.append((k, flow))
    if visits or goal is not None:
        for coordinate in sorted({i for i, _ in shape.recoveries.values()}):
            last = None if goal is None else float(goal[coordinate])
            angle = float(start[coordinate])
            visits = _centre(shape, visits, coordinate, angle, last, ends)
    ordered: list[list[Flow]] = [[] for _ in segments]
    for visit in visits:
        for name, duration in visit.recoveries.items():
            ordered[visit.segment].append(Flow(visit.stratum, name, duration))
        for segment, flow in visit.strokes:
            ordered[segment].append(flow)
    return ordered


def _centre(
    shape: ShapeCoordinates,
    visits: list[_Visit],
    coordinate: int,
    angle: float,
    last: float | None,
    ends: tuple[str, str],
) -> list[_Visit]:
    """Visits with recoveries that centre the strokes of one coordinate on zero."""
    recoveries = {
        shape.system.stratum_of[name]: (name, rate)
        for name, (moved, rate) in shape.recoveries.items()
        if moved == coordinate
    }
    rates = {name: float(rate[coordinate]) for name, rate in shape.rates.items()}
    done, previous = list[_Visit](), -1

    def recover(amount: float, following: _Visit) -> None:
        if abs(amount) > SHORTEST_RECOVERY:
            between = previous + 1, following
            place = _place(shape.system, done, recoveries, between, ends[0])
            name, rate = recoveries[place.stratum]
            place.recoveries[name] = amount / rate

    for visit in visits:
        if load := visit.load(rates):
            middle, net = load
            recover(-middle - angle, visit)
            angle, previous = net - middle, len(done)
        done.append(visit)
    if last is not None:
        recover(last - angle, _Visit(ends[1], done[-1].segment if done else 0))
    return done


def _place(
    system: StratifiedSystem,
    done: list[_Visit],
    recoveries: Mapping[str, tuple[str, float]],
    between: tuple[int, _Visit],
    depart: str,
) -> _Visit:
    """The latest visit that allows the recovery, or a new one of fewest switches.

    It is not before the first visit that comes into question, by its index, and before
    the visit that follows all of them.
    """
    first, following = between
    for visit in reversed(done[first:]):
        if visit.stratum in recoveries:
            return visit
    strata = [depart, *(visit.stratum for visit in done), following.stratum]

    def added(place: tuple[int, str]) -> int:
        (before, after), stratum = strata[place[0] : place[0] + 2], place[1]
        through = system.switches(before, stratum) + system.switches(stratum, after)
        return through - system.switches(before, after)

    k, stratum = min(product(range(first, len(done) + 1), recoveries), key=added)
    done.insert(k, _Visit(stratum, [*done, following][k].segment if k else 0))
    return done[k]
