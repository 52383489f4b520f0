"""Centre every stroke on shape zero by means of recoveries.

A stroke is the swing of a loaded leg, a recovery the swing of a leg in the air. A
recovery moves one shape coordinate on which no field depends, so it commutes with all
flows and does not move the body. The recoveries of a plan are therefore replaced by
others: before each visit with a stroke, the leg is brought to where the stroke will be
centred on zero. The body moves as before, and the legs stay near the middle of their
range.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from planner.numerics.arrays import Array
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

NEGLIGIBLE = 1e-12  # a recovery shorter than this is a rounding error


@dataclass(slots=True)
class _Visit:
    """A stay on one stratum: recoveries first, then strokes."""

    stratum: str
    segment: int  # to which its recoveries belong
    recoveries: dict[str, float] = field(default_factory=dict)  # duration by field
    strokes: list[tuple[int, Flow]] = field(default_factory=list)  # with their segment
    runs: list[tuple[str, float]] = field(default_factory=list)  # strokes, joined

    def add(self, segment: int, flow: Flow) -> None:
        """Append a stroke."""
        self.strokes.append((segment, flow))
        before = 0.0
        if self.runs and self.runs[-1][0] == flow.field:
            _, before = self.runs.pop()
        self.runs.append((flow.field, before + flow.duration))

    def load(self, rates: Mapping[str, float]) -> tuple[float, float] | None:
        """Middle and end of a coordinate's strokes, from their start; None if none."""
        lowest = highest = net = 0.0
        loaded = False
        for name, duration in self.runs:
            if rate := rates[name]:
                loaded = True
                net += rate * duration
                lowest, highest = min(lowest, net), max(highest, net)
        return ((lowest + highest) / 2, net) if loaded else None


def centred(
    shape: ShapeCoordinates,
    segments: Sequence[Sequence[Flow]],
    start: Array,
    goal: Array | None,
    ends: tuple[str, str],
) -> list[list[Flow]]:
    """Flows that move the body as given ones do, with every stroke centred on zero.

    Args:
        shape: Shape coordinates of the system.
        segments: Flows of each segment, grouped by stratum.
        start: Configuration before the first flow, shape (n,).
        goal: Configuration whose shape to end in; None leaves the legs where they are.
        ends: Strata before the first flow and after the last one.
    """
    visits = list(_visits(shape, segments))
    if visits or goal is not None:
        for coordinate in sorted({i for i, _ in shape.recoveries.values()}):
            last = None if goal is None else float(goal[coordinate])
            _centre(shape, visits, coordinate, float(start[coordinate]), last, ends)
    ordered: list[list[Flow]] = [[] for _ in segments]
    for visit in visits:
        for name, duration in visit.recoveries.items():
            ordered[visit.segment].append(Flow(visit.stratum, name, duration))
        for segment, flow in visit.strokes:
            ordered[segment].append(flow)
    return ordered


def _visits(
    shape: ShapeCoordinates, segments: Sequence[Sequence[Flow]]
) -> Iterator[_Visit]:
    """Visits without the recoveries of the plan; some visits may be left empty."""
    visit = None
    for k, flows in enumerate(segments):
        for flow in flows:
            if visit is None or visit.stratum != flow.stratum:
                if visit is not None:
                    yield visit
                visit = _Visit(flow.stratum, k)
            if flow.field not in shape.recoveries:
                visit.add(k, flow)
    if visit is not None:
        yield visit


def _centre(
    shape: ShapeCoordinates,
    visits: list[_Visit],
    coordinate: int,
    angle: float,
    last: float | None,
    ends: tuple[str, str],
) -> None:
    """Add recoveries that centre the strokes of one coordinate on zero."""
    recoveries = {
        shape.system.stratum_of[name]: (name, rate)
        for name, (moved, rate) in shape.recoveries.items()
        if moved == coordinate
    }
    rates = {name: float(rate[coordinate]) for name, rate in shape.rates.items()}
    previous, i = -1, 0
    while i < len(visits):
        if load := visits[i].load(rates):
            middle, net = load
            if abs(-middle - angle) > NEGLIGIBLE:
                place, added = _place(
                    shape.system, visits, recoveries, (previous, i), ends
                )
                name, rate = recoveries[place.stratum]
                place.recoveries[name] = (-middle - angle) / rate
                i += added
            angle, previous = net - middle, i
        i += 1
    if last is not None and abs(last - angle) > NEGLIGIBLE:
        place, _ = _place(
            shape.system, visits, recoveries, (previous, len(visits)), ends
        )
        name, rate = recoveries[place.stratum]
        place.recoveries[name] = (last - angle) / rate


def _place(
    system: StratifiedSystem,
    visits: list[_Visit],
    recoveries: Mapping[str, tuple[str, float]],
    between: tuple[int, int],
    ends: tuple[str, str],
) -> tuple[_Visit, bool]:
    """The latest visit between two others that allows the recovery, or a new visit.

    A new visit is inserted where it adds fewest contact switches.
    """
    first, last = between
    for visit in reversed(visits[first + 1 : last]):
        if visit.stratum in recoveries:
            return visit, False

    def before(k: int) -> str:
        return visits[k - 1].stratum if k else ends[0]

    def added(place: tuple[int, str]) -> int:
        k, stratum = place
        after = visits[k].stratum if k < len(visits) else ends[1]
        through = system.switches(before(k), stratum) + system.switches(stratum, after)
        return through - system.switches(before(k), after)

    k, stratum = min(
        ((k, stratum) for k in range(first + 1, last + 1) for stratum in recoveries),
        key=added,
    )
    segment = visits[min(k, len(visits) - 1)].segment if k else 0
    visits.insert(k, _Visit(stratum, segment))
    return visits[k], True
