"""Plans: from a nominal path to flows on strata, the five steps of Sec. 5.2."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from planner.collocation import collocation
from planner.errors import RangeError
from planner.extended import ExtendedSystem, extend
from planner.fields import Array
from planner.flows import Flow, contact_switches, visits
from planner.grouping import regroup
from planner.paths import Path, as_path, grid
from planner.shape import Limits, Shape
from planner.stance import centred
from planner.steering import Order
from planner.strata import StratifiedSystem

Stance = Literal["paper", "centred"]
Coordinates = Literal["backward", "forward", "fewest"]

ORDERS: dict[Coordinates, tuple[Order, ...]] = {
    "backward": ("backward",),
    "forward": ("forward",),
    "fewest": ("backward", "forward"),
}
MOST_SEGMENTS = 100_000  # tried when a plan's range asks for more segments


@dataclass(frozen=True, eq=False)
class Plan:
    """Flows that take a system along a path.

    Attributes:
        system: System that the flows are of.
        elements: Elements of the extended system, p names.
        basis: Names of the Hall coordinates, s of them.
        flows: Flows in time order, joined within segments.
        segment_ends: For each segment the number of flows up to its end.
        inputs: Fictitious inputs at nodes of segments of unit duration, shape
            (segments, nodes, p).
        hall_coordinates: Backward Hall coordinates of each segment, shape (segments, s).
        start: Configuration that the plan starts from, shape (n,).
        goal: Configuration that the path ends in, shape (n,).
    """

    system: StratifiedSystem
    elements: tuple[str, ...]
    basis: tuple[str, ...]
    flows: tuple[Flow, ...]
    segment_ends: tuple[int, ...]
    inputs: Array
    hall_coordinates: Array
    start: Array
    goal: Array

    @property
    def contact_switches(self) -> int:
        """Commanded lifts plus landings."""
        return contact_switches(self.system, self.flows)

    def segments(self) -> Iterator[tuple[Flow, ...]]:
        """The flows of each segment."""
        for first, last in zip(
            (0, *self.segment_ends), self.segment_ends, strict=False
        ):
            yield self.flows[first:last]

    def __str__(self) -> str:
        lines = [
            f"{len(self.segment_ends)} segments, {len(self.flows)} flows, "
            f"{self.contact_switches} contact switches; elements {', '.join(self.elements)}"
        ]
        for k, flows in enumerate(self.segments(), start=1):
            stays = (
                f"S{stay[0].stratum} "
                + " ".join(f"{f.duration:+.6g} {f.field}" for f in stay)
                for stay in visits(flows)
            )
            lines.append(f"{k:4d}  " + " | ".join(stays))
        return "\n".join(lines)


def plan(
    system: StratifiedSystem | ExtendedSystem,
    path: Path | Callable[[float], ArrayLike],
    segments: int,
    elements: Sequence[str] | None = None,
    *,
    stance: Stance = "paper",
    limits: Limits | None = None,
    coordinates: Coordinates = "fewest",
    finish: bool = True,
    nodes: int | None = None,
) -> Plan:
    """Plan flows along a path, open loop (Sec. 5.2).

    Args:
        system: System to steer; compiled by `extend` beforehand where speed matters.
        path: Configurations for s in [0, 1] over the whole state, on the bottom stratum.
        segments: Number of pieces that the path is cut into, each planned by itself.
        elements: Fields and brackets of the extended system; not with a compiled one.
        stance: `paper` keeps the printed order, `centred` puts every sweep under load
            around shape zero by swings in the air.
        limits: Lowest and highest value of shape coordinates by name.
        coordinates: Hall coordinates that the flows follow; `fewest` takes for each
            segment those that switch contacts least.
        finish: Whether a centred plan ends by bringing the legs to the goal's shape.
        nodes: Points at which a segment of the path is sampled; more for long segments
            if not given.

    Raises:
        ValueError: An argument is out of range or misshapen, or the path is not finite.
        PlannerError: The elements do not reach the path's velocity, or lose rank on it.
        RangeError: The plan leaves the limits; it says how many segments would do.
    """
    extended = _extended(system, elements)
    if segments < 1:
        raise ValueError(f"segments is {segments}; at least 1 is needed")
    planner = _Planner(
        extended, as_path(path), stance, limits or {}, coordinates, finish
    )
    try:
        return planner.plan(segments, nodes)
    except RangeError as error:
        raise error.with_segments(planner.enough(segments)) from None


@dataclass(frozen=True, eq=False)
class _Planner:
    """What stays the same when the number of segments changes."""

    extended: ExtendedSystem
    path: Path
    stance: Stance
    limits: Limits
    coordinates: Coordinates
    finish: bool

    def plan(self, segments: int, nodes: int | None = None) -> Plan:
        """The five steps, then the order of flows."""
        samples = sample(
            self.path, self.extended.system, segments, nodes or default_nodes(segments)
        )
        inputs = fictitious_inputs(self.extended, samples)
        hall_coordinates = self.extended.steering.hall_coordinates(inputs)
        start, goal = samples[0, 0], samples[-1, -1]
        ordered = self._order(hall_coordinates, start, goal)
        flows = tuple(flow for segment in ordered for flow in segment)
        self.extended.shape.require_within(self.limits, flows, start)
        return Plan(
            self.extended.system,
            self.extended.elements,
            self.extended.steering.basis,
            flows,
            tuple(np.cumsum([len(segment) for segment in ordered]).tolist()),
            inputs,
            hall_coordinates,
            start,
            goal,
        )

    def _order(
        self, hall_coordinates: Array, start: Array, goal: Array
    ) -> list[list[Flow]]:
        bottom = self.extended.system.bottom
        words = self.extended.words(hall_coordinates, ORDERS[self.coordinates])
        ordered = regroup(self.extended.grouper, words, bottom, bottom)
        if self.stance == "paper":
            return ordered
        last = goal if self.finish else None
        return centred(self.extended.shape, ordered, start, last, (bottom, bottom))

    def enough(self, segments: int) -> int | None:
        """The smallest number of segments found that keeps the limits."""
        low, high = segments, 2 * segments
        while not self._fits(high):
            low, high = high, 2 * high
            if high > MOST_SEGMENTS:
                return None
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if self._fits(middle) else (middle, high)
        return high

    def _fits(self, segments: int) -> bool:
        try:
            self.plan(segments)
        except RangeError:
            return False
        return True


def default_nodes(segments: int) -> int:
    """Nodes a segment that follow a smooth closed path to rounding, however it is cut."""
    return max(5, 1 + math.ceil(40 / segments))


def sample(path: Path, system: StratifiedSystem, segments: int, nodes: int) -> Array:
    """Configurations at the nodes of each segment, shape (segments, nodes, n).

    Raises:
        ValueError: The path's shape does not match the state, or it is not finite.
    """
    cuts = grid(path, segments)
    inner = cuts[:-1, None] + np.diff(cuts)[:, None] * collocation(nodes).nodes[:-1]
    parameters = np.append(inner.ravel(), 1.0)
    values = path.at(parameters)
    if values.shape != (parameters.size, system.dimension):
        raise ValueError(
            f"path returns shape {values.shape[1:]}, expected ({system.dimension},): "
            f"{', '.join(map(str, system.state))}"
        )
    if not np.isfinite(values).all():
        s = parameters[~np.isfinite(values).all(axis=1)][0]
        raise ValueError(f"path is not finite at s = {s:.6g}")
    starts = values[:-1].reshape(segments, nodes - 1, -1)
    ends = values[nodes - 1 :: nodes - 1, None]
    return np.concatenate([starts, ends], axis=1)


def fictitious_inputs(extended: ExtendedSystem, samples: Array) -> Array:
    """Inputs that follow sampled segments in unit time each, zero where nothing moves.

    The path is differentiated as the polynomial through its samples, so that the
    integral of its velocity meets the segment's end exactly.
    """
    segments, nodes, _ = samples.shape
    inputs = np.zeros((segments, nodes, len(extended.elements)))
    moving = np.ptp(samples, axis=1).any(axis=1)
    if moving.any():
        velocity = collocation(nodes).derivative @ samples[moving]
        inputs[moving] = extended.fictitious_inputs(samples[moving], velocity)
    return inputs


def _extended(
    system: StratifiedSystem | ExtendedSystem, elements: Sequence[str] | None
) -> ExtendedSystem:
    if isinstance(system, ExtendedSystem):
        if elements is not None:
            raise ValueError("elements are given twice: the system is extended already")
        return system
    if elements is None:
        raise ValueError(
            "elements are missing; name fields that span the bottom stratum"
        )
    return extend(system, elements)
