"""Step between sweeps: every sweep under load starts from legs set anew around zero.

Feet that stay where they are while several fields flow make the motion holonomic: legs
that come back bring the body back, and a commutator of such fields moves nothing but by
slip. So between sweeps of different fields, and between parts of one that is too long,
every leg is set in the air: those that sweep next to where they will sweep around
zero, the others to zero. The plan's own air swings are dropped, as they do not matter.

Where lifting a foot would tip the robot it leans first, along a field under load, and
straightens up when all legs are set. Such a field commutes with what legs do in the
air, so leaning cancels.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from planner.errors import StratumError
from planner.fields import Array
from planner.flows import Flow, merged
from planner.shape import Limits, Shape

NEGLIGIBLE = 1e-12  # swings shorter than this are rounding
ROUNDING = 1e-9  # of a sweep that just fits


@dataclass(frozen=True, slots=True)
class Lean:
    """The posture that a stratum asks for before its feet lift.

    Attributes:
        field: Field to lean along.
        coordinates: Shape coordinates whose mean says how far the robot leans.
        at: What the mean must reach, or be beyond on the same side of zero.
    """

    field: str
    coordinates: tuple[str, ...]
    at: float


Leans = Mapping[str, Lean]
"""Postures by stratum."""


def stepped(
    shape: Shape,
    segments: Sequence[Sequence[Flow]],
    start: Array,
    goal: Array | None,
    limits: Limits,
    leans: Leans,
) -> list[list[Flow]]:
    """The same flows under load, with every leg set anew before each.

    Args:
        shape: Shape coordinates of the system.
        segments: Flows of each segment in time order.
        start: Configuration before the first flow, shape (n,).
        goal: Configuration whose shape to return to; None lets the legs be.
        limits: Lowest and highest value of shape coordinates by name; a sweep that
            would leave them is made in parts.
        leans: Postures in which legs lift.

    Raises:
        StratumError: A coordinate that sweeps under load never swings in the air.
    """
    legs = _Legs(shape, start, limits, leans)
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
        self, shape: Shape, start: Array, limits: Limits, leans: Leans
    ) -> None:
        self.shape, self.leans = shape, leans
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
        parts = self._parts(flow.duration * rates)
        part = flow._replace(duration=flow.duration / parts)
        for _ in range(parts):
            yield from self.set({i: -part.duration * rates[i] / 2 for i in self.airs})
            yield part
            self.now += part.duration * rates

    def _parts(self, way: Array) -> int:
        """How often the legs must be set anew to stay within their range."""
        strokes = (
            abs(way[i]) / self._stroke(low, high)
            for i, (low, high) in self.spans.items()
        )
        return max(1, ceil(max(strokes, default=0.0) - ROUNDING))

    def _stroke(self, low: float, high: float) -> float:
        """The longest sweep within a range, and after which leaning stays within it.

        To lean from half a stroke on one side to beyond zero on the other takes the
        legs that are set already half a stroke and the lean farther.
        """
        if not self.leans:
            return 2 * min(high, -low)
        return min(high, -low) - max(abs(lean.at) for lean in self.leans.values())

    def set(self, targets: Mapping[int, float]) -> list[Flow]:
        """Bring coordinates to their targets in the air.

        The robot leans as far one way as the other: what leaning along legs that point
        differently adds to the motion cancels then, but for a turn.
        """
        moving = [i for i in targets if abs(targets[i] - self.now[i]) > NEGLIGIBLE]
        most = max((abs(self._lacking(i, targets)) for i in moving), default=0.0)
        flows: list[Flow] = []
        leant = 0.0
        field = next((lean.field for lean in self.leans.values()), "")
        for i in sorted(moving, key=lambda i: (self._side(i), i)):
            by = self._side(i) * most
            flows += self._flow(field, by - leant)
            leant = by
            ahead = leant * self.shape.rates[field][i] if field else 0.0
            unit, rate = self.airs[i]
            duration = (targets[i] + ahead - self.now[i]) / rate
            flows.append(unit._replace(duration=duration))
            self.now[i] = targets[i] + ahead
        return flows + self._flow(field, -leant)

    def _side(self, leg: int) -> float:
        """Which way to lean before a leg lifts: 1, -1, or 0 for upright."""
        lean = self.leans.get(self.airs[leg][0].stratum)
        return 0.0 if lean is None else float(np.sign(lean.at))

    def _lacking(self, leg: int, targets: Mapping[int, float]) -> float:
        """How far to lean before a leg may lift, wherever the others are just then."""
        lean = self.leans.get(self.airs[leg][0].stratum)
        if lean is None:
            return 0.0
        side = float(np.sign(lean.at))
        some = [self.shape.names.index(name) for name in lean.coordinates]
        rate = float(np.mean(self.shape.rates[lean.field][some]))
        least = np.mean(
            [min(side * self.now[i], side * targets.get(i, self.now[i])) for i in some]
        )
        return max(0.0, abs(lean.at) - float(least)) / abs(rate)

    def _flow(self, field: str, duration: float) -> list[Flow]:
        if abs(duration) <= NEGLIGIBLE:
            return []
        self.now += duration * np.nan_to_num(self.shape.rates[field])
        return [Flow(self.shape.system.stratum_of[field], field, duration)]
