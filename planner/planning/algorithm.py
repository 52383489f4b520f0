"""Plans: from a nominal path to flows on strata, the five steps of Sec. 5.2."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import RangeError, ResolutionError, unknown
from planner.execution.execution import Coordinates, Execution, StanceRule
from planner.execution.stepping import StabilityTest
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.nominal import (
    default_nodes,
    extend_along,
    fictitious_inputs,
    require_segments,
    sample,
)
from planner.planning.paths import Path, as_path
from planner.planning.regularity import require_regular
from planner.systems.elements import parse
from planner.systems.flows import Flow, contact_switches, require_flows, visits
from planner.systems.shape import ShapeLimits
from planner.systems.strata import StratifiedSystem

MOST_TRIED = 10_000  # when a plan's range asks for more segments


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
        hall_coordinates: Backward coordinates of each segment, shape (segments, s).
        start: Configuration that the plan starts from, shape (n,).
        goal: Configuration that the path ends in, shape (n,).
        depart: Stratum at rest before the first flow.
        arrive: Stratum at rest after the last one.

    Raises:
        ValueError: Something is misshapen, not finite, or not of the system.
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
    depart: str
    arrive: str

    def __post_init__(self) -> None:
        require_flows(self.system, self.flows)
        for element in self.elements:
            parse(element, self.system)
        for name in (self.depart, self.arrive):
            if name not in self.system.strata:
                known = unknown(name, self.system.strata)
                raise ValueError(f"stratum {name!r} {known}")
        ends = (0, *self.segment_ends)
        if list(ends) != sorted(ends) or ends[-1] != len(self.flows):
            raise ValueError(
                f"segment_ends do not ascend to the number of flows, {len(self.flows)}"
            )
        self._require_shapes()

    def _require_shapes(self) -> None:
        segments, state = len(self.segment_ends), (self.system.dimension,)
        nodes = self.inputs.shape[1:2]
        for name, shape in (
            ("start", state),
            ("goal", state),
            ("hall_coordinates", (segments, len(self.basis))),
            ("inputs", (segments, *nodes, len(self.elements))),
        ):
            value = getattr(self, name)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(
                    f"{name} of shape {value.shape} should be {shape} finite numbers"
                )

    @property
    def contact_switches(self) -> int:
        """Commanded lifts plus landings."""
        return contact_switches(self.system, self.flows, self.depart, self.arrive)

    def segments(self) -> Iterator[tuple[Flow, ...]]:
        """The flows of each segment."""
        for first, last in zip(
            (0, *self.segment_ends), self.segment_ends, strict=False
        ):
            yield self.flows[first:last]

    def __str__(self) -> str:
        lines = [
            f"{len(self.segment_ends)} segments, {len(self.flows)} flows, "
            f"{self.contact_switches} contact switches; "
            f"elements {', '.join(self.elements)}"
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
    stance: StanceRule = "paper",
    limits: ShapeLimits | None = None,
    static_stability: StabilityTest | None = None,
    coordinates: Coordinates = "fewest",
    finish: bool = True,
    depart: str = "",
    arrive: str = "",
    nodes: int | None = None,
) -> Plan:
    """Plan flows along a path, open loop (Sec. 5.2).

    Args:
        system: System to steer; compiled by `extend` beforehand where speed matters.
        path: Configurations on the bottom stratum for s in [0, 1].
        segments: Number of pieces that the path is cut into, each planned by itself.
        elements: Fields and brackets of the extended system, chosen by
            `extension.choice` if not given; not with a compiled one.
        stance: As in `execution.execution.Execution`, like the next six.
        limits: Lowest and highest value of shape coordinates by name.
        static_stability: Where the robot stands with a leg in the air.
        coordinates: Hall coordinates to follow.
        finish: Whether a centred plan ends in the goal's shape.
        depart: Stratum at rest before the plan.
        arrive: Stratum at rest after it.
        nodes: Points at which a segment of the path is sampled; more for long segments
            if not given.

    Raises:
        ValueError: An argument is out of range or misshapen, or the path is not finite
            or not on the bottom stratum.
        PlannerError: The elements lose rank on the path, or do not reach its velocity,
            or the path has a corner for every segment.
        RangeError: The plan leaves the limits; it says how many segments would do.
    """
    nominal = as_path(path)
    require_segments(segments, nominal)
    extended = extend_along(system, elements, nominal)
    execution = Execution(
        stance=stance,
        coordinates=coordinates,
        limits=limits or {},
        static_stability=static_stability,
        finish=finish,
        depart=depart,
        arrive=arrive,
    )
    try:
        return follow_path(extended, nominal, segments, execution, nodes)
    except RangeError as error:
        raise with_remedy(error, extended, nominal, segments, execution) from None


def follow_path(
    extended: ExtendedSystem,
    path: Path,
    segments: int,
    execution: Execution,
    nodes: int | None = None,
) -> Plan:
    """The five steps of Sec. 5.2 for one number of segments.

    Raises:
        RangeError: The plan leaves the limits; how many segments would do is not tried.
    """
    nodes = nodes or default_nodes(segments)
    samples = sample(path, extended.system, segments, nodes)
    inputs = fictitious_inputs(extended, samples)
    require_regular(extended, samples, inputs)
    hall_coordinates = extended.steering.hall_coordinates(inputs)
    ends = samples[0, 0], samples[-1, -1]
    return assemble(extended, inputs, hall_coordinates, ends, execution)


def assemble(
    extended: ExtendedSystem,
    inputs: Array,
    hall_coordinates: Array,
    ends: tuple[Array, Array],
    execution: Execution,
) -> Plan:
    """The plan that carries out given Hall coordinates.

    Args:
        extended: System that they are of.
        inputs: Fictitious inputs behind them, shape (segments, nodes, p).
        hall_coordinates: Backward coordinates, shape (segments, s).
        ends: Start and goal, of shape (n,) each.
        execution: How to carry them out.
    """
    start, goal = ends
    ordered = execution.flows(extended, hall_coordinates, start, goal)
    return Plan(
        system=extended.system,
        elements=extended.elements,
        basis=extended.steering.basis,
        flows=tuple(flow for flows in ordered for flow in flows),
        segment_ends=tuple(np.cumsum([len(flows) for flows in ordered]).tolist()),
        inputs=inputs,
        hall_coordinates=hall_coordinates,
        start=start,
        goal=goal,
        depart=execution.depart or extended.system.bottom,
        arrive=execution.arrive or extended.system.bottom,
    )


def with_remedy(
    refusal: RangeError,
    extended: ExtendedSystem,
    path: Path,
    segments: int,
    execution: Execution,
) -> RangeError:
    """A refusal with the smallest number of segments found to keep the limits.

    Args:
        refusal: What the plan was refused with.
        extended: System to steer.
        path: Configurations on the bottom stratum for s in [0, 1].
        segments: A number that does not do; others are tried open loop.
        execution: How to carry them out.
    """
    for end in (path(0.0), path(1.0)):
        try:
            extended.shape.require_within(execution.limits, (), end)
        except RangeError:
            return refusal.with_segments(None, "no number of segments would do")

    def fits(segments: int) -> bool:
        try:
            follow_path(extended, path, segments, execution)
        except (RangeError, ResolutionError):
            return False
        return True

    low, high = segments, 2 * segments
    while not fits(high):
        low, high = high, 2 * high
        if high > MOST_TRIED:
            return refusal.with_segments(None, f"{low} segments would not do")
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if fits(middle) else (middle, high)
    return refusal.with_segments(high)
