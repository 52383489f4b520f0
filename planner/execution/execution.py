"""How Hall coordinates are carried out: the words, their order, and centring.

This is the last step of Sec. 5.2: the flows of all segments are regrouped by stratum,
with the fewest contact switches, and kept within the range of the legs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain
from typing import Literal, get_args

from planner.errors import RangeError, StratumError, unknown
from planner.execution.centring import centred
from planner.execution.nearest_words import nearest_signs, nearest_words
from planner.execution.stepping import StabilityTest, stepped
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Spelled, Wording
from planner.numerics.arrays import Array
from planner.systems.flows import Flow, Word
from planner.systems.gait import regroup_in_gait
from planner.systems.grouping import regroup
from planner.systems.shape import ShapeLimits

StanceRule = Literal["paper", "centred", "stepped"]
Coordinates = Literal["backward", "forward", "fewest", "shortest", "symmetric"]

CHOICES: Mapping[str, tuple[tuple[Wording, ...], ...]] = {
    "backward": (("backward",),),
    "forward": (("forward",),),
    "shortest": (("shortest",),),
    "symmetric": (("alternating",),),
    "fewest": (("backward", "forward"), ("backward",), ("forward",)),
}
"""Sets of words to choose from; the next set is tried if limits refuse the plan."""
SIGNED: tuple[Spelled, ...] = ("backward", "forward")
SIGNED_FROM = 3  # degree of words whose signs are tried; below, rectangles have corners


@dataclass(frozen=True, kw_only=True)
class Execution:
    """Choices that affect the order of flows and the trajectory of the legs only.

    Attributes:
        stance: `paper` keeps the order of the paper. `centred` centres every stroke on
            shape zero by recoveries. `stepped` repositions every leg before each
            stroke.
        coordinates: Hall coordinates that the flows follow. `fewest` takes for each
            segment those with fewest contact switches, or those that end nearest to
            their goal where the degree of the approximation is raised beyond that of
            the elements, and runs generators forward or backward as suits the fields.
            `shortest` takes the words of least total duration,
            `symmetric` mirrors the words of every second segment, so that the errors
            of neighbours cancel.
        limits: Lowest and highest value of shape coordinates by name.
        static_stability: Whether the robot is statically stable with a leg in the air,
            for `stepped`; None if it always is.
        finish: Whether the plan ends by bringing the legs to the shape of the goal.
        depart: Stratum before the first flow; the bottom stratum if empty.
        arrive: Stratum after the last flow; the bottom stratum if empty.
        gait: Closed walk whose order the strata are visited in, eq. (11); any order
            if empty.

    Raises:
        ValueError: A choice is unknown.

    Example:
        >>> from planner import Execution, StratifiedSystem, line, plan
        >>> fields = {"f": [1, 0, 0], "g": [0, 1, "x"]}
        >>> system = StratifiedSystem("x y z", {"0": fields}, "0")
        >>> path, order = line((0, 0, 0), (0, 0, 1)), Execution(coordinates="forward")
        >>> [str(flow) for flow in plan(system, path, 1, execution=order).flows]
        ['S0: +1 f', 'S0: +1 g', 'S0: -1 f', 'S0: -1 g']
    """

    stance: StanceRule = "paper"
    coordinates: Coordinates = "fewest"
    limits: ShapeLimits = field(default_factory=dict)
    static_stability: StabilityTest | None = None
    finish: bool = True
    depart: str = ""
    arrive: str = ""
    gait: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.stance not in get_args(StanceRule):
            known = unknown(self.stance, get_args(StanceRule))
            raise ValueError(f"stance {self.stance!r} {known}")
        if self.coordinates not in CHOICES:
            known = unknown(self.coordinates, CHOICES)
            raise ValueError(f"coordinates {self.coordinates!r} {known}")

    def flows(
        self, extended: ExtendedSystem, hall_coordinates: Array, nominal: Array
    ) -> list[list[Flow]]:
        """Flows of each segment in time order, within the limits.

        Takes backward coordinates (segments, s), and the configurations (segments + 1,
        n) between segments, the first and the one whose shape to end in included.
        """
        *choices, last_choice = CHOICES[self.coordinates]
        for orders in choices:
            with suppress(RangeError):
                return self._flows(extended, hall_coordinates, nominal, orders)
        return self._flows(extended, hall_coordinates, nominal, last_choice)

    def _flows(
        self,
        extended: ExtendedSystem,
        hall_coordinates: Array,
        nominal: Array,
        orders: Sequence[Wording],
    ) -> list[list[Flow]]:
        """Flows of words in one of the orders, a segment each."""
        system, steering = extended.system, extended.steering
        ends = (self.depart or system.bottom, self.arrive or system.bottom)
        for name in ends:
            if name not in system.strata:
                raise StratumError(f"stratum {name!r} {unknown(name, system.strata)}")
        start, shape_after = nominal[0], nominal[-1] if self.finish else None
        if steering.raised and len(orders) > 1:
            ways = [nearest_words(extended, hall_coordinates, nominal)]
        else:
            ways = self._words(extended, hall_coordinates, nominal, orders)
        words = list(zip(*ways, strict=True))
        if self.gait:
            ordered = regroup_in_gait(extended.grouper, words, self.gait, ends[0])
        else:
            ordered = regroup(extended.grouper, words, *ends)
        if self.stance == "centred":
            ordered = centred(extended.shape, ordered, start, shape_after, ends)
        if self.stance == "stepped":
            rules = self.limits, self.static_stability
            ordered = stepped(extended.shape, ordered, start, shape_after, *rules)
        extended.shape.require_within(self.limits, chain(*ordered), start)
        return ordered

    def _words(
        self,
        extended: ExtendedSystem,
        hall_coordinates: Array,
        nominal: Array,
        orders: Sequence[Wording],
    ) -> list[list[Word]]:
        """Words of all segments in each of the orders, with signs that suit them."""
        steering, plain = extended.steering, [o for o in SIGNED if o in orders]
        if steering.degree < SIGNED_FROM or self.coordinates != "fewest":
            starts = nominal[:-1]
            return [steering.words(hall_coordinates, o, starts) for o in orders]
        signs = nearest_signs(extended, hall_coordinates, nominal, plain)
        measured, units = steering.measured(hall_coordinates, nominal[:-1])
        return [steering.scaled_words(measured, o, units * signs) for o in plain]
