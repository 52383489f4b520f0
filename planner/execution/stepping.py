"""Step between sweeps: every sweep under load starts from legs set anew around zero.

Feet that stay where they are while several fields flow make the motion holonomic: legs
that come back bring the body back, and a commutator of such fields moves nothing but by
slip. So between sweeps of different fields, and between parts of one that is too long,
every leg is set in the air: those that sweep next to where they will sweep around
zero, the others to zero. The plan's own air swings are dropped, as they do not matter.
The body stands still meanwhile: legs lift in an order in which the others stand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil

import numpy as np

from planner.errors import StratumError
from planner.execution.centring import NEGLIGIBLE
from planner.execution.repositioning import reposition_legs
from planner.numerics.arrays import Array
from planner.systems.flows import Flow, merged
from planner.systems.shape import ShapeCoordinates, ShapeLimits

ROUNDING = 1e-9  # of a sweep that just fits
MOST_PARTS = 32  # more than a robot takes that can set its legs at all

StabilityTest = Callable[[Sequence[str], Mapping[str, Array]], Array]
"""Whether a robot stands on each of S strata, for all combinations of places of its
shape coordinates: from the places by name, (P_i,), to bool, (S, P_1, P_2, ...)."""


def stepped(
    shape: ShapeCoordinates,
    segments: Sequence[Sequence[Flow]],
    start: Array,
    goal: Array | None,
    limits: ShapeLimits,
    static_stability: StabilityTest | None,
) -> list[list[Flow]]:
    """The same flows under load, with every leg set anew before each.

    Args:
        shape: Shape coordinates of the system.
        segments: Flows of each segment in time order.
        start: Configuration before the first flow, shape (n,).
        goal: Configuration whose shape to return to; None lets the legs be.
        limits: Lowest and highest value of shape coordinates by name; a sweep that
            would leave them is made in parts.
        static_stability: Where the robot stands with a leg in the air; None where it
            always does.

    Raises:
        StratumError: A coordinate that sweeps under load never swings in the air, or
            legs cannot be set without tipping.
    """
    legs = _Legs(shape, start, limits, static_stability)
    ordered: list[list[Flow]] = []
    for flows in segments:
        loaded = merged(flow for flow in flows if flow.field not in shape.free)
        steps = [step for flow in loaded for step in legs.sweep(flow)]
        ordered.append(list(merged(steps)))
    if goal is not None and ordered:
        ordered[-1] += legs.set({i: float(goal[i]) for i in legs.airs})
    return ordered


class _Legs:
    """Where the shape coordinates are, and how to set them in the air."""

    def __init__(
        self,
        shape: ShapeCoordinates,
        start: Array,
        limits: ShapeLimits,
        static_stability: StabilityTest | None,
    ) -> None:
        self.shape, self.static_stability = shape, static_stability
        self.now = np.array(start, dtype=float)
        self.airs: dict[int, tuple[Flow, float]] = {}  # one unit of it, and its rate
        for name, (i, rate) in shape.free.items():
            unit = Flow(shape.system.stratum_of[name], name, 1.0)
            self.airs.setdefault(i, (unit, rate))
        self.spans = {shape.names.index(name): span for name, span in limits.items()}

    def sweep(self, flow: Flow) -> Iterator[Flow]:
        """A flow under load, in parts, each with the legs set before it."""
        rates = np.nan_to_num(self.shape.rates[flow.field])
        if stuck := [i for i in self.spans if rates[i] and i not in self.airs]:
            raise StratumError(
                f"{flow.field} sweeps {self.shape.names[stuck[0]]}, which no field "
                "swings in the air; the legs cannot be set anew"
            )
        self._require_room(flow, rates)
        parts = self._parts(flow.duration * rates)
        part = flow._replace(duration=flow.duration / parts)
        for _ in range(parts):
            yield from self.set({i: -part.duration * rates[i] / 2 for i in self.airs})
            yield part
            self.now += part.duration * rates

    def _require_room(self, flow: Flow, rates: Array) -> None:
        for i, (low, high) in self.spans.items():
            if rates[i] and not low < 0 < high:
                raise StratumError(
                    f"{flow.field} sweeps {self.shape.names[i]} around zero, not "
                    f"inside its range {low:g} to {high:g}; give it some on both sides"
                )

    def _parts(self, way: Array) -> int:
        """How often the legs must be set anew, within their range and without tipping.

        Legs that can be set from zero can be set back to it, and so from the end of any
        sweep for any other one.
        """
        strokes = (
            abs(way[i]) / (2 * min(high, -low))
            for i, (low, high) in self.spans.items()
            if way[i]
        )
        fewest = max(1, ceil(max(strokes, default=0.0) - ROUNDING))
        rest = dict.fromkeys(self.airs, 0.0)
        for parts in range(fewest, fewest + MOST_PARTS):
            ends = ({i: side * way[i] / parts for i in rest} for side in (-0.5, 0.5))
            if all(self._moves(rest, end) is not None for end in ends):
                return parts
        raise StratumError(
            "legs cannot be set one after another from where they are all at zero: the "
            "others would tip; put the weight where one leg can lift, or groups of "
            "legs that stand in turn"
        )

    def set(self, targets: Mapping[int, float]) -> list[Flow]:
        """Bring coordinates to their targets in the air.

        Raises:
            StratumError: There is no order in which the robot keeps standing.
        """
        now = {i: float(self.now[i]) for i in targets}
        moves = self._moves(now, targets)
        if moves is None:
            angles = ", ".join(f"{self.shape.names[i]} = {now[i]:.4g}" for i in now)
            raise StratumError(f"no leg can be set without tipping from {angles}")
        flows: list[Flow] = []
        for i, place in moves:
            unit, rate = self.airs[i]
            flows.append(unit._replace(duration=(place - self.now[i]) / rate))
            self.now[i] = place
        return flows

    def _moves(
        self, now: Mapping[int, float], targets: Mapping[int, float]
    ) -> list[tuple[int, float]] | None:
        """The cheapest moves, by way of zero and the ends of the range if need be."""
        legs = sorted(targets)
        if self.static_stability is None:
            return [(i, targets[i]) for i in legs if _apart(now[i], targets[i])]
        places = [self._places(i, now[i], targets[i]) for i in legs]
        named = dict(zip((self.shape.names[i] for i in legs), places, strict=True))
        steady = self.static_stability([self.airs[i][0].stratum for i in legs], named)
        goal = [int(_apart(now[i], targets[i])) for i in legs]
        moves = reposition_legs(places, steady, [0] * len(legs), goal)
        return moves and [(legs[leg], place) for leg, place in moves]

    def _places(self, i: int, now: float, target: float) -> Array:
        """Where a coordinate is, where it is to be, zero, and the ends of its range."""
        kept = [now]
        for place in (target, 0.0, *self.spans.get(i, ())):
            if all(_apart(place, other) for other in kept):
                kept.append(place)
        return np.array(kept)


def _apart(one: float, other: float) -> bool:
    return abs(one - other) > NEGLIGIBLE
