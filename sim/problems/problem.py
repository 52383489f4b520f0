"""The one way in which planning problems are solved: plan, check, optimise, remedy.

A problem is a scenario's, a robot with its path, or a system's, which has no body.
"""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

import planner
from planner.execution import Coordinates
from planner.support import limited, unlimited
from sim.errors import SimulationError, StratawalkError

NO_SHORTER = "no shorter plan was found"
FAR_OFF = 0.05  # of the way; where a plan ends farther off, changes are tried
ENOUGH = 3  # changes that end near the goal
TRIAL_TIME = 30.0  # [s]

Offer = tuple[str, Callable[[], float]]  # a change in words, and what is missed then


class Solution(NamedTuple):
    """A plan, and why it is the stratified one where an optimised one was asked for."""

    plan: planner.Plan
    fallback: str | None = None


class Problem(ABC):
    """What is to be reached, and by which plans."""

    objective: str  # time, strokes or switches; none for a stratified plan
    replan: bool  # plan each segment from where the one before ended
    words: str  # flows of a segment: printed, shortest or symmetric
    segments: int
    plan_time: float  # [s], that planning may take
    extended: planner.ExtendedSystem
    path: planner.Path
    coordinates: Coordinates
    is_exact: bool = False  # plans of any number of segments meet the goal

    @property
    @abstractmethod
    def stratified(self) -> planner.Plan:
        """The plan by the algorithm of Sec. 5.2."""

    def check(self, plan: planner.Plan) -> None:  # noqa: B027 a system has no body to check
        """Refuse a plan that cannot be carried out, with a `SimulationError`."""

    @property
    def has_fallback(self) -> bool:
        """Whether the stratified plan is as good as what is asked for demands."""
        return True

    @abstractmethod
    def shortest(self) -> planner.Plan:
        """The best plan that the optimiser finds within tolerances and time."""

    @abstractmethod
    def worth(self, plan: planner.Plan) -> float:
        """What is to be least, of a whole plan."""

    @abstractmethod
    def miss(self, plan: planner.Plan) -> float:
        """How far a plan ends off the goal, as a share of the way there."""

    @abstractmethod
    def changed(self, degree: int = 0, **options: object) -> "Problem":
        """The same problem with another degree, words, segments or replanning."""

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
        """Plan, check and optimise; where nothing shorter is found, the plan stands.

        The errors are those of planning, of bounds that no plan keeps, of time, and of
        plans that cannot be carried out.
        """
        if self.objective == "none":
            return self._checked(self.stratified)
        if not self.has_fallback:
            return Solution(self._sound_shortest())
        with unlimited():
            other = self.stratified
        try:
            found = self._sound_shortest()
        except (planner.BoundError, planner.BudgetError) as error:
            return self._checked(other, str(error))
        if self.worth(found) < self.worth(other):
            return Solution(found)
        return self._checked(other, NO_SHORTER)

    def _checked(self, plan: planner.Plan, fallback: str | None = None) -> Solution:
        self.check(plan)
        return Solution(plan, fallback)

    def _sound_shortest(self) -> planner.Plan:
        found = self.shortest()
        try:
            self.check(found)
        except SimulationError as error:
            why = f"the shortest plan found is refused: {error}"
            raise planner.BoundError(why) from error
        return found

    def refusal(self, error: planner.RangeError) -> planner.PlannerError:
        """The error of a plan that no number of segments makes fit, and what may."""
        found = tried(self._remedies(), math.inf, self.plan_time)
        return planner.PlannerError(f"{error}; what helps: {found}")

    def helps(self, plan: planner.Plan) -> str:
        """What would help a plan that ends far off its goal; empty for others."""
        if (miss := self.miss(plan)) <= FAR_OFF:
            return ""
        return self.reason() or str(tried(self._remedies(), miss, self.plan_time))

    def _remedies(self) -> Iterator[Offer]:
        """Changes to try where a plan ends far off, the cheapest first."""

        def offer(option: str, degree: int = 0, **options: object) -> Offer:
            return option, lambda: self.changed(degree, **options).attempt()

        if self.words == "printed":
            yield offer("--words symmetric", words="symmetric")
        degree = self.extended.steering.degree + 1
        yield offer(f"--degree {degree}", degree)
        for count in (times * self.segments for times in (4, 16)):  # finer
            yield offer(f"--segments {count}", segments=count)
        if not self.replan:
            yield offer("--replan", replan=True)
        yield from self.own_remedies()
        if not self.replan:
            yield "half of the way", partial(self.attempt, 0.5)


class Trials(NamedTuple):
    """Changes that were tried in turn."""

    helpful: dict[str, float]  # what the plan misses then, as a share of the way
    useless: tuple[str, ...]  # that help too little, or give no plan

    def __str__(self) -> str:
        if self.helpful:
            best = list(self.helpful.items())[:ENOUGH]
            return "; ".join(f"{name} ends {100 * off:.2g} % off" for name, off in best)
        if self.useless:
            return f"nothing that was tried: {', '.join(self.useless)}"
        return "nothing could be tried in time"


def tried(offers: Iterable[Offer], miss: float, seconds: float) -> Trials:
    """Try changes in turn; one helps if it at least halves what the plan misses.

    The miss is a share of the way, infinite where there is no plan. Trying takes no
    longer than planning may take [s], and ends where enough was found.
    """
    found, useless = dict[str, float](), list[str]()
    end = time.monotonic() + min(seconds, TRIAL_TIME)
    for change, attempt in offers:
        left = end - time.monotonic()
        if left <= 0 or sum(off <= FAR_OFF for off in found.values()) >= ENOUGH:
            break
        try:
            with limited(left):
                reached = attempt()
        except planner.BudgetError:
            break
        except (planner.PlannerError, StratawalkError, ValueError):
            reached = math.inf  # no plan at all
        if reached <= 0.5 * miss and reached < math.inf:  # a change that helps
            found[change] = reached
        else:
            useless.append(change)
    return Trials(dict(sorted(found.items(), key=lambda f: f[1])), tuple(useless))
