"""The motion planning algorithm of Sec. 5.2: from a nominal path to flows on strata."""

from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import accumulate, chain, pairwise

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import RangeError, ResolutionError, message, require_known
from planner.execution.execution import Execution
from planner.extension.extended import ExtendedSystem
from planner.numerics.arrays import Array
from planner.planning.nominal import (
    Steerable,
    default_nodes,
    extend_along,
    fictitious_inputs_along,
    require_regular,
    require_segments,
    require_use,
    sample,
)
from planner.planning.paths import Path, as_path
from planner.support.stopping import tick
from planner.systems.elements import parse
from planner.systems.flows import Flow, contact_switches, require_flows, visits
from planner.systems.formulas import HUGE
from planner.systems.strata import StratifiedSystem

SHOWN = 3  # segments of a plan in words, before its last one
MOST_TRIED = 10_000  # segments, where a plan needs more of them to keep its limits


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """Flows that take a system along a path (Sec. 5.2).

    Attributes:
        system: System that the flows are of.
        elements: Elements of the extended system, p names.
        basis: Names of the Hall coordinates, s of them.
        flows: Flows in time order; those of one field are joined within segments.
        segment_ends: For each segment the number of flows up to its end.
        inputs: Fictitious inputs, eq. (5), at the nodes of segments of unit duration,
            shape (segments, nodes, p).
        hall_coordinates: Backward coordinates of each segment, eq. (9), shape
            (segments, s).
        nominal: Configurations on the path between segments, its start and its goal
            included, shape (segments + 1, n).
        depart: Stratum before the first flow.
        arrive: Stratum after the last flow.
        gait: Closed walk whose order the strata are visited in; empty if in any.

    Raises:
        ValueError: A value is misshapen or not finite, or names what the system lacks.

    Example:
        >>> from planner import EXAMPLES, line, plan
        >>> found = plan(EXAMPLES["heisenberg"], line((0, 0, 0), (0, 0, 1)), 1)
        >>> found.elements, found.hall_coordinates
        (('f', 'g', '[f,g]'), array([[0., 0., 1.]]))
    """

    system: StratifiedSystem
    elements: tuple[str, ...]
    basis: tuple[str, ...]
    flows: tuple[Flow, ...]
    segment_ends: tuple[int, ...]
    inputs: Array
    hall_coordinates: Array
    nominal: Array
    depart: str
    arrive: str
    gait: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_flows(self.system, self.flows)
        for element in self.elements:
            parse(element, self.system)
        for name in (self.depart, self.arrive):
            require_known(f"stratum {name!r}", name, self.system.strata)
        ends = (0, *self.segment_ends)
        if list(ends) != sorted(ends) or ends[-1] != len(self.flows):
            raise ValueError(message("unordered", count=len(self.flows)))
        segments, nodes = len(self.segment_ends), self.inputs.shape[1:2]
        for name, value, shape in (
            ("nominal", self.nominal, (segments + 1, self.system.dimension)),
            ("hall_coordinates", self.hall_coordinates, (segments, len(self.basis))),
            ("inputs", self.inputs, (segments, *nodes, len(self.elements))),
        ):
            if value.shape != shape or not (abs(value) < HUGE).all():
                facts = {"name": name, "shape": value.shape, "wanted": shape}
                raise ValueError(message("should_be", **facts))

    @property
    def start(self) -> Array:
        """Configuration that the plan starts from, shape (n,)."""
        return self.nominal[0]

    @property
    def goal(self) -> Array:
        """Configuration that the path ends in, shape (n,)."""
        return self.nominal[-1]

    @property
    def contact_switches(self) -> int:
        """Number of lift-offs and touchdowns."""
        ends = self.depart, self.arrive
        return contact_switches(self.system, self.flows, *ends, self.gait)

    def segments(self) -> Iterator[tuple[Flow, ...]]:
        """The flows of each segment."""
        for first, last in pairwise((0, *self.segment_ends)):
            yield self.flows[first:last]

    @property
    def _size(self) -> str:
        segments, flows = len(self.segment_ends), len(self.flows)
        parts = f"{segments} segment{'s' * (segments > 1)}, {flows} flows"
        return f"{parts}, {self.contact_switches} contact switches"

    def __repr__(self) -> str:
        return f"<Plan: {self._size}>"

    def __str__(self) -> str:
        def written(stay: Sequence[Flow]) -> str:
            moves = " ".join(f"{f.duration:+.6g} {f.field}" for f in stay)
            return f"S{stay[0].stratum} {moves}"

        lines = [f"{self._size}; elements {', '.join(self.elements)}"]
        *first, last = enumerate(self.segments(), start=1)
        for k, flows in (*first[:SHOWN], last):
            if k > SHOWN + 1:
                lines.append(f"      and {k - SHOWN - 1} more; segments() has them all")
            lines.append(f"{k:4d}  " + " | ".join(map(written, visits(flows))))
        return "\n".join(lines)


def plan(
    system: StratifiedSystem | ExtendedSystem | Steerable,
    path: Path | Callable[[float], ArrayLike],
    segments: int,
    elements: Iterable[str] | None = None,
    *,
    execution: Execution | None = None,
    nodes: int | None = None,
    degree: int | None = None,
) -> Plan:
    """Plan flows along a path, open loop (Sec. 5.2).

    Args:
        system: System to steer.
        path: Configurations on the bottom stratum for s in [0, 1], or poses of the body
            if the system is that of a robot.
        segments: Number of segments of the path, each of which is planned separately.
        elements: Fields and brackets of the extended system. If they are not given,
            they are those of the robot's equations, or chosen by `extension.choice`.
        execution: How the flows are ordered, and within which limits. By default it is
            that of the robot's equations, or the order of the paper.
        nodes: Number of samples of the path in each segment; larger for long segments
            if it is not given.
        degree: Degree of the nilpotent approximation, the "higher order" of Sec. 6, to
            which words are exact; that of elements or extended system by default.

    Raises:
        ValueError: An argument is out of range or misshapen, or the path is not finite
            or not on the bottom stratum.
        PlannerError: The elements lose rank on the path, do not reach its velocity, or
            are nearly singular and end no nearer to the goal; or corners are too many.
        RangeError: The plan leaves the limits; it suggests a number of segments.

    Example:
        >>> from planner import EXAMPLES, line, plan
        >>> found = plan(EXAMPLES["heisenberg"], line((0, 0, 0), (0, 0, 1)), 1)
        >>> list(map(str, found.flows))
        ['S0: +1 f', 'S0: +1 g', 'S0: -1 f', 'S0: -1 g']
    """
    nominal = as_path(path)
    if not isinstance(system, StratifiedSystem | ExtendedSystem):
        nominal = system.configurations(nominal)
        elements = system.elements if elements is None else elements
        execution = execution or system.execution
        system = system.system
    require_segments(segments, nominal)
    extended = extend_along(system, elements, nominal)
    if degree is not None:
        extended = extended.to_degree(degree)
    execution = execution or Execution()
    if not isinstance(execution, Execution):
        raise ValueError(f"execution is {execution!r}; give an Execution, or none")
    try:
        planned = follow_path(extended, nominal, segments, execution, nodes)
        require_use(extended, planned.nominal, planned.flows)
        return planned
    except RangeError as error:
        raise with_remedy(error, extended, nominal, segments, execution) from None


def follow_path(
    extended: ExtendedSystem,
    path: Path,
    segments: int,
    execution: Execution,
    nodes: int | None = None,
) -> Plan:
    """The five steps of Sec. 5.2 for one number of segments; no other is tried."""
    samples = sample(path, extended.system, segments, nodes or default_nodes(segments))
    tick()
    inputs = fictitious_inputs_along(extended, samples)
    tick()
    require_regular(extended, samples, inputs)
    hall_coordinates = extended.steering.hall_coordinates(inputs)
    nominal = np.concatenate([samples[:, 0], samples[-1:, -1]])
    return assemble(extended, inputs, hall_coordinates, nominal, execution)


def assemble(
    extended: ExtendedSystem,
    inputs: Array,
    hall_coordinates: Array,
    nominal: Array,
    execution: Execution,
) -> Plan:
    """The plan for given Hall coordinates (step 5 of Sec. 5.2); shapes as in `Plan`."""
    ordered = execution.flows(extended, hall_coordinates, nominal)
    basis, elements = extended.steering.basis, extended.elements
    made = plan_of_flows(extended.system, elements, ordered, nominal, basis)
    depart, arrive = execution.depart or made.depart, execution.arrive or made.arrive
    made = replace(made, depart=depart, arrive=arrive, gait=execution.gait)
    return replace(made, inputs=inputs, hall_coordinates=hall_coordinates)


def plan_of_flows(
    system: StratifiedSystem,
    elements: tuple[str, ...],
    segments: Sequence[Sequence[Flow]],
    nominal: Array,
    basis: tuple[str, ...] = (),
) -> Plan:
    """A plan of given flows, whose inputs and Hall coordinates count for nothing."""
    return Plan(
        system=system,
        elements=elements,
        basis=basis,
        flows=tuple(chain.from_iterable(segments)),
        segment_ends=tuple(accumulate(map(len, segments))),
        inputs=np.zeros((len(segments), 1, len(elements))),
        hall_coordinates=np.zeros((len(segments), len(basis))),
        nominal=nominal,
        depart=system.bottom,
        arrive=system.bottom,
    )


def with_remedy(
    refusal: RangeError,
    extended: ExtendedSystem,
    path: Path,
    segments: int,
    execution: Execution,
) -> RangeError:
    """The error with the fewest segments, beyond those given, that keep the limits."""
    for end in (path(0.0), path(1.0)):
        try:
            extended.shape.require_within(execution.limits, (), end)
        except RangeError:
            return refusal.with_segments(None, "no number of segments suffices")

    def fits(segments: int) -> bool:
        tick(f"trying whether {segments} segments suffice")
        with suppress(RangeError, ResolutionError):
            return bool(follow_path(extended, path, segments, execution))
        return False

    low, high = segments, 2 * segments
    while not fits(high):
        low, high = high, 2 * high
        if high > MOST_TRIED:
            return refusal.with_segments(None, f"{low} segments do not suffice")
    between = range(low + 1, high)
    return refusal.with_segments(low + 1 + bisect_left(between, True, key=fits))
