"""The one way in which planning problems are solved: plan, check, optimise, remedy.

A problem is a scenario's, a robot with its path, or a system's, which has no body. Both
go through the same stages; a system passes over those that need a body.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial

from planner import (
    BoundError,
    BudgetError,
    ExtendedSystem,
    Path,
    Plan,
    PlannerError,
    RangeError,
)
from planner.execution import Coordinates
from planner.support import limited, unlimited
from sim.errors import SimulationError, StratawalkError

NO_SHORTER = "no shorter plan was found"
FAR_OFF = 0.05  # of the way; where a plan ends farther off, changes are tried
LEFT_BY_HELP = 0.5  # of what the plan misses, that a change may leave
ENOUGH = 3  # changes that end near the goal
TRIAL_TIME = 30.0  # [s]
TIMES_FINER = (4, 16)  # as many segments

Offer = tuple[str, Callable[[], float]]  # a change in words, and what is missed then


@dataclass(frozen=True, slots=True)
class Solution:
    """The plan of a problem.

    Attributes:
        plan: The plan.
        fallback: Why the stratified plan stands instead of an optimised one; None where
            nothing else was asked for.
    """

    plan: Plan
    fallback: str | None = None


class Problem(ABC):
    """What is to be reached, and by which plans.

    Attributes:
        objective: What is to be least: time, strokes or switches; none for a
            stratified plan.
        replan: Whether each segment is planned from where the one before ended.
        words: Flows of a segment: printed, shortest or symmetric.
        segments: Number of pieces of the path.
        plan_time: Time that planning may take [s].
        extended: The extended system.
        path: Configurations to follow.
        coordinates: Hall coordinates to follow.
        is_exact: Whether plans of any number of segments meet the goal.
    """

    objective: str
    replan: bool
    words: str
    segments: int
    plan_time: float
    extended: ExtendedSystem
    path: Path
    coordinates: Coordinates
    is_exact: bool = False

    @property
    @abstractmethod
    def stratified(self) -> Plan:
        """The plan by the algorithm of Sec. 5.2.

        Raises:
            PlannerError: If there is none.
        """

    def check(self, plan: Plan) -> None:  # noqa: B027 a system has no body to check
        """Refuse a plan that cannot be carried out.

        Raises:
            SimulationError: It says why.
        """

    @property
    def has_fallback(self) -> bool:
        """Whether the stratified plan is as good as what is asked for demands."""
        return True

    @abstractmethod
    def shortest(self) -> Plan:
        """The best plan that the optimiser finds.

        Raises:
            BoundError: If none keeps the tolerances.
            BudgetError: If the time is over before there is one.
        """

    @abstractmethod
    def worth(self, plan: Plan) -> float:
        """What is to be least, of a whole plan."""

    @abstractmethod
    def miss(self, plan: Plan) -> float:
        """How far a plan ends off the goal, as a share of the way there."""

    @abstractmethod
    def changed(
        self,
        *,
        words: str | None = None,
        degree: int | None = None,
        segments: int | None = None,
        replan: bool | None = None,
    ) -> Problem:
        """The same problem with other options; those that are None stay."""

    @abstractmethod
    def attempt(self, share: float = 1.0) -> float:
        """What a stratified plan for the first part of the way misses of its end."""

    def own_remedies(self) -> Iterator[Offer]:
        """Changes that only this kind of problem knows."""
        yield from ()

    def reason(self) -> str:
        """Why no change would help; empty if one may."""
        return ""

    def solve(self) -> Solution:
        """Plan, check and optimise.

        The stratified plan is the first guess of an optimised one, and stands where
        nothing shorter is found.

        Raises:
            PlannerError: If there is no plan.
            BoundError: If no plan keeps the tolerances; it says which would be kept.
            BudgetError: If the time is over before there is one.
            SimulationError: If the plan cannot be carried out.
        """
        if self.objective == "none":
            return self._checked(self.stratified)
        if not self.has_fallback:
            return Solution(self._sound_shortest())
        with unlimited():
            other = self.stratified
        try:
            found = self._sound_shortest()
        except (BoundError, BudgetError) as error:
            return self._checked(other, str(error))
        if self.worth(found) < self.worth(other):
            return Solution(found)
        return self._checked(other, NO_SHORTER)

    def _checked(self, plan: Plan, fallback: str | None = None) -> Solution:
        self.check(plan)
        return Solution(plan, fallback)

    def _sound_shortest(self) -> Plan:
        found = self.shortest()
        try:
            self.check(found)
        except SimulationError as error:
            raise BoundError(f"the shortest plan found is refused: {error}") from error
        return found

    def refusal(self, error: RangeError) -> PlannerError:
        """The error of a plan that no number of segments makes fit, and what may."""
        return PlannerError(f"{error}; tried: {self._tried(math.inf)}")

    def helps(self, plan: Plan) -> str:
        """What would help a plan that ends far off its goal; empty for others."""
        miss = self.miss(plan)
        if miss <= FAR_OFF:
            return ""
        return self.reason() or str(self._tried(miss))

    def _tried(self, miss: float) -> Trials:
        return tried(self.remedies(), miss, self.plan_time)

    def remedies(self) -> Iterator[Offer]:
        """Changes to try where a plan ends far off, the cheapest first."""

        def offer(option: str, change: Callable[[], Problem]) -> Offer:
            return option, lambda: change().attempt()

        if self.words == "printed":
            yield offer("--words symmetric", partial(self.changed, words="symmetric"))
        degree = self.extended.steering.degree + 1
        yield offer(f"--degree {degree}", partial(self.changed, degree=degree))
        for count in (times * self.segments for times in TIMES_FINER):
            yield offer(f"--segments {count}", partial(self.changed, segments=count))
        if not self.replan:
            yield offer("--replan", partial(self.changed, replan=True))
        yield from self.own_remedies()
        if not self.replan:
            yield "half of the way", partial(self.attempt, 0.5)


@dataclass(frozen=True, slots=True)
class Remedy:
    """A change that was tried.

    Attributes:
        change: What was changed, as on the command line where there is an option.
        miss: How far the plan ends off its goal then, as a share of the way.
    """

    change: str
    miss: float

    def __str__(self) -> str:
        return f"{self.change} ends {100 * self.miss:.2g} % off"


@dataclass(frozen=True, slots=True)
class Trials:
    """Changes that were tried in turn.

    Attributes:
        helpful: Those that help, the best first.
        useless: Those that do not, or give no plan.
    """

    helpful: tuple[Remedy, ...]
    useless: tuple[str, ...]

    def __str__(self) -> str:
        if self.helpful:
            return "; ".join(map(str, self.helpful[:ENOUGH]))
        if self.useless:
            return f"nothing that was tried: {', '.join(self.useless)}"
        return "nothing could be tried in time"


def tried(offers: Iterable[Offer], miss: float, seconds: float) -> Trials:
    """Try changes in turn; one helps if it at least halves what the plan misses.

    The miss is a share of the way, infinite where there is no plan. Trying takes no
    longer than planning may take [s], and ends where enough was found.
    """
    found: list[Remedy] = []
    useless: list[str] = []
    end = time.monotonic() + min(seconds, TRIAL_TIME)
    for change, attempt in offers:
        left = end - time.monotonic()
        if left <= 0 or sum(remedy.miss <= FAR_OFF for remedy in found) >= ENOUGH:
            break
        try:
            with limited(left):
                reached = attempt()
        except BudgetError:
            break
        except (PlannerError, StratawalkError, ValueError):
            reached = math.inf  # no plan at all
        if reached <= LEFT_BY_HELP * miss and reached < math.inf:
            found.append(Remedy(change, reached))
        else:
            useless.append(change)
    found.sort(key=lambda remedy: remedy.miss)
    return Trials(tuple(found), tuple(useless))
