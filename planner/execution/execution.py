"""How Hall coordinates are carried out: the words, their order, and centring.

This is the last step of Sec. 5.2: the flows of all segments are regrouped by stratum,
with the fewest contact switches, and kept within the range of the legs.

Words of an approximation of degree k miss brackets of degree k + 1, in two orders of
the same flows by amounts that may differ a hundredfold. Where a degree beyond that of
the elements asks for accuracy, words are therefore played, with each generator run
forward or backward first. Signs are chosen once for all segments, on a sample of them,
where there are many, or the elements alone are of degree 3 and more.
"""

import gc
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain, product
from typing import Literal, get_args

import numpy as np

from planner.errors import RangeError, StratumError, require_known
from planner.execution.centring import centred
from planner.execution.stepping import StabilityTest, stepped
from planner.extension.extended import ExtendedSystem
from planner.extension.steering import Spelled, Wording
from planner.numerics.arrays import Array
from planner.systems.flows import Flow, Word, word_ends
from planner.systems.grouping import regroup, regroup_in_gait
from planner.systems.shape import ShapeLimits
from planner.systems.strata import StratifiedSystem

StanceRule = Literal["paper", "centred", "stepped"]
Coordinates = Literal["backward", "forward", "fewest", "shortest", "symmetric"]

CHOICES: Mapping[str, tuple[tuple[Wording, ...], ...]] = {
    "backward": (("backward",),),
    "forward": (("forward",),),
    "shortest": (("shortest",),),
    "symmetric": (("alternating",),),
    "fewest": (("backward", "forward"), ("backward",), ("forward",)),
}  # sets of words to choose from; the next set is tried if limits refuse the plan
ORDERS: tuple[Wording, ...] = get_args(Spelled)
SIGNED_FROM = 3  # degree of words whose signs are tried; below, rectangles have corners
SAMPLE = 8  # segments whose words are played
EQUAL = 1e-6  # relative difference of misses that is taken for rounding
AS_GOOD = 1.02  # times the smallest miss, with which the printed signs are kept


@contextmanager
def uncollected() -> Iterator[None]:
    """Pause Python's garbage collector while many lasting objects are made.

    In a plan of thousands of segments it takes a third of the time and finds nothing.
    """
    collected = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collected:
            gc.enable()


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
        >>> from planner import EXAMPLES, Execution, line, plan
        >>> path, order = line((0, 0, 0), (0, 0, 1)), Execution(coordinates="forward")
        >>> found = plan(EXAMPLES["heisenberg"], path, 1, execution=order)
        >>> list(map(str, found.flows))
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
        require_known(f"stance {self.stance!r}", self.stance, get_args(StanceRule))
        require_known(f"coordinates {self.coordinates!r}", self.coordinates, CHOICES)

    @uncollected()
    def flows(
        self, extended: ExtendedSystem, hall_coordinates: Array, nominal: Array
    ) -> list[list[Flow]]:
        """Flows of each segment in time order, within the limits.

        Takes backward coordinates (segments, s), and the configurations (segments + 1,
        n) between segments, the first and the one whose shape to end in included.
        """
        *choices, last_choice = CHOICES[self.coordinates]
        spelled = extended.steering.speller(hall_coordinates, nominal[:-1])
        asked = extended, hall_coordinates, nominal, spelled
        for orders in choices:
            with suppress(RangeError):
                return self._flows(*asked, orders)
        return self._flows(*asked, last_choice)

    def _flows(
        self,
        extended: ExtendedSystem,
        hall_coordinates: Array,
        nominal: Array,
        spelled: Callable[[Wording], list[Word]],
        orders: Sequence[Wording],
    ) -> list[list[Flow]]:
        """Flows of words in one of the orders, a segment each."""
        system, steering = extended.system, extended.steering
        ends = (self.depart or system.bottom, self.arrive or system.bottom)
        for name in ends:
            require_known(f"stratum {name!r}", name, system.strata, StratumError)
        start, shape_after = nominal[0], nominal[-1] if self.finish else None
        if steering.raised and len(orders) > 1:
            ways = [nearest_words(extended, hall_coordinates, nominal)]
        elif steering.degree < SIGNED_FROM or self.coordinates != "fewest":
            ways = [spelled(order) for order in orders]
        else:
            signs = nearest_signs(extended, hall_coordinates, nominal, orders)
            measured, units = steering.measured(hall_coordinates, nominal[:-1])
            ways = [steering.scaled_words(measured, o, units * signs) for o in orders]
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


def nearest_words(
    extended: ExtendedSystem, hall_coordinates: Array, nominal: Array
) -> list[Word]:
    """The word of each segment, in any order and signs, that ends nearest to its goal.

    Coordinates and configurations are those of `Execution.flows`.
    """
    steering = extended.steering
    every = list(steering.signs)
    if len(hall_coordinates) > SAMPLE:
        every = [nearest_signs(extended, hall_coordinates, nominal, ORDERS)]
    hall_coordinates, units = steering.measured(hall_coordinates, nominal[:-1])
    ways = [
        steering.scaled_words(hall_coordinates, order, units * signs)
        for signs, order in product(every, ORDERS)
    ]
    misses = _misses(extended.system, ways, nominal[:-1], nominal[1:])
    nearest = list[Word]()
    for words, missed in zip(zip(*ways, strict=True), misses.T, strict=True):
        # words that mirror one another miss alike, and in turn they make up for that
        equal = np.flatnonzero(missed <= missed.min() * (1.0 + EQUAL))
        nearest.append(words[equal[-(len(nearest) % 2)]])
    return nearest


def nearest_signs(
    extended: ExtendedSystem,
    hall_coordinates: Array,
    nominal: Array,
    orders: Sequence[Wording],
) -> Array:
    """Signs (m,) of the generators with which words in the orders end nearest to goals.

    They are those of the units themselves where these are as good as any.
    """
    steering, count = extended.steering, len(hall_coordinates)
    sample = np.unique(np.linspace(0, count - 1, SAMPLE).round().astype(int))
    starts, goals = nominal[sample], nominal[sample + 1]
    coordinates, units = (
        each[sample] for each in steering.measured(hall_coordinates, nominal[:-1])
    )
    ways = [
        steering.scaled_words(coordinates, order, units * signs)
        for signs, order in product(steering.signs, orders)
    ]
    missed = _misses(extended.system, ways, starts, goals).sum(axis=1)
    misses = missed.reshape(len(steering.signs), -1).min(axis=1)
    # the first of the smallest; words that mirror one another miss alike
    best = int(np.argmax(misses <= misses.min() * (1.0 + EQUAL)))
    return steering.signs[0 if misses[0] <= misses[best] * AS_GOOD else best]


def _misses(
    system: StratifiedSystem, ways: list[list[Word]], starts: Array, goals: Array
) -> Array:
    """How far words end from goals, (ways, segments); infinite if they escape."""
    begin = np.tile(starts, (len(ways), 1))
    ends = word_ends(system, [*chain(*ways)], begin).reshape(len(ways), *goals.shape)
    return np.nan_to_num(system.length(ends - goals), nan=np.inf)
