"""How Hall coordinates are carried out: which words, in which order, how centred.

The last step of Sec. 5.2: flows of all segments, regrouped by stratum with the fewest
contact switches, within the range of the legs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Literal, get_args

from planner.errors import RangeError, StratumError, unknown
from planner.execution.centring import centred
from planner.execution.stepping import StabilityTest, stepped
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Wording
from planner.numerics.arrays import Array
from planner.systems.flows import Flow
from planner.systems.grouping import regroup
from planner.systems.shape import ShapeLimits

StanceRule = Literal["paper", "centred", "stepped"]
Coordinates = Literal["backward", "forward", "fewest", "shortest"]

CHOICES: Mapping[str, tuple[tuple[Wording, ...], ...]] = {
    "backward": (("backward",),),
    "forward": (("forward",),),
    "shortest": (("shortest",),),
    "fewest": (("backward", "forward"), ("backward",), ("forward",)),
}
"""Words to choose from in each segment, and again where limits refuse the plan."""


@dataclass(frozen=True, kw_only=True)
class Execution:
    """Choices that change the order of flows and the course of legs, not the goal.

    Attributes:
        stance: `paper` keeps the printed order, `centred` puts every sweep under load
            around shape zero by swings in the air, `stepped` sets every leg anew
            before each sweep.
        coordinates: Hall coordinates that the flows follow; `fewest` takes for each
            segment those that switch contacts least, `shortest` takes words that sweep
            least.
        limits: Lowest and highest value of shape coordinates by name.
        static_stability: Where the robot stands with a leg in the air, for `stepped`;
            None where it always does.
        finish: Whether centred flows end by bringing the legs to the goal's shape.
        depart: Stratum at rest before the first flow; the bottom stratum if empty.
        arrive: Stratum at rest after the last one; the bottom stratum if empty.

    Raises:
        ValueError: A choice is unknown.
    """

    stance: StanceRule = "paper"
    coordinates: Coordinates = "fewest"
    limits: ShapeLimits = field(default_factory=dict)
    static_stability: StabilityTest | None = None
    finish: bool = True
    depart: str = ""
    arrive: str = ""

    def __post_init__(self) -> None:
        if self.stance not in get_args(StanceRule):
            raise ValueError(
                f"stance {self.stance!r} {unknown(self.stance, get_args(StanceRule))}"
            )
        if self.coordinates not in CHOICES:
            raise ValueError(
                f"coordinates {self.coordinates!r} {unknown(self.coordinates, CHOICES)}"
            )

    def flows(
        self,
        extended: ExtendedSystem,
        hall_coordinates: Array,
        nominal: Array,
    ) -> list[list[Flow]]:
        """Flows of each segment in time order, within the limits.

        Args:
            extended: System that the coordinates are of.
            hall_coordinates: Backward coordinates, shape (segments, s).
            nominal: Configurations between segments, before the first flow and the one
                whose shape to end in included, shape (segments + 1, n).

        Raises:
            StratumError: `depart` or `arrive` is unknown or cannot be joined.
            RangeError: The flows leave the limits.
        """
        *choices, last_choice = CHOICES[self.coordinates]
        for orders in choices:
            try:
                return self._flows(extended, hall_coordinates, nominal, orders)
            except RangeError:
                continue
        return self._flows(extended, hall_coordinates, nominal, last_choice)

    def _flows(
        self,
        extended: ExtendedSystem,
        hall_coordinates: Array,
        nominal: Array,
        orders: Sequence[Wording],
    ) -> list[list[Flow]]:
        """Flows of words in one of the orders, a segment each."""
        ends = self._ends(extended)
        start, goal = nominal[0], nominal[-1]
        steering = extended.steering
        ways = [
            steering.words(hall_coordinates, order, nominal[:-1]) for order in orders
        ]
        words = list(zip(*ways, strict=True))
        ordered = regroup(extended.grouper, words, *ends)
        if self.stance == "centred":
            shape_after = goal if self.finish else None
            ordered = centred(extended.shape, ordered, start, shape_after, ends)
        if self.stance == "stepped":
            shape_after = goal if self.finish else None
            rules = self.limits, self.static_stability
            ordered = stepped(extended.shape, ordered, start, shape_after, *rules)
        extended.shape.require_within(self.limits, chain(*ordered), start)
        return ordered

    def _ends(self, extended: ExtendedSystem) -> tuple[str, str]:
        system = extended.system
        ends = (self.depart or system.bottom, self.arrive or system.bottom)
        for name in ends:
            if name not in system.strata:
                raise StratumError(f"stratum {name!r} {unknown(name, system.strata)}")
        return ends
