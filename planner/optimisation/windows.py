"""The search for the number of stages of a plan for a part of the path.

A program has a fixed number of stages. With fewer stages a plan switches contacts less
often and makes longer strokes, until the tolerances of the path can no longer be met.
The search finds the smallest number of stages that meets them, and looks for the best
plan from there upward.

Inequalities that may be violated, such as clearances, make a solution several times as
expensive, and from a poor first guess most of them lead nowhere. The search therefore
leaves them out at first. Its solutions are the first guesses of a second search with
them, which begins with the smallest number of stages that the first one has found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from planner.errors import BudgetError
from planner.numerics.arrays import Array
from planner.optimisation.guesses import Coarse, guesses
from planner.optimisation.program import Program
from planner.optimisation.requirements import TIGHTER
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path
from planner.support.stopping import answer, tick

MOST = 96  # stages of a window
BOTH = 20  # stages up to which the first may be any of the cycle's
ROUGHLY = 2  # guesses that decide whether a number of stages will do
CLOSELY = 5  # guesses at numbers of stages near the fewest
FEW = 2  # guesses there, once all inequalities are kept, which decide more than they do
STRIDE = 1.1  # from one number of stages that is tried to the next
WORSE = 2  # numbers of stages without progress, after which the search ends
BETTER = 0.999  # of the least so far, which is progress
KEPT = 1.0 + 1e-6  # width, in tolerances, that counts as keeping them
STEEPNESS = 0.8  # growth of the stages for each tolerance that is lacking
WORKED = 0.97  # share of a window's work that is left after each solution, as reported

Score = Callable[[Solution], float]
Report = Callable[[float], None]
Trial = tuple[int, int, int]  # number of stages, the first of them, and of the guess


@dataclass(frozen=True, eq=False, slots=True)
class Window:
    """A part of the path, and the state in which the motion comes to it.

    Attributes:
        start: The state, shape (n,).
        ends: Where on the path the part begins and ends.
        goal: State to end in, shape (n,); None for any within the tolerances.
        first: Number of the first stage since the start.
    """

    start: Array
    ends: tuple[float, float]
    goal: Array | None
    first: int

    @property
    def begins(self) -> bool:
        """Whether the motion begins here, so that any stage may be the first."""
        return self.ends[0] == 0.0


@dataclass
class Programs:
    """Programs of a task along a path, each built once.

    Attributes:
        task: What to optimise.
        path: Configurations to follow.
    """

    task: Task
    path: Path
    _built: dict[tuple[int, int], Program] = field(default_factory=dict)

    def __call__(self, count: int, first: int) -> Program:
        """The program for a number of stages, from one of them on."""
        key = count, first % len(self.task.stages)
        if key not in self._built:
            self._built[key] = Program(self.task, self.path, *key)
        return self._built[key]


@dataclass
class WindowSearch:
    """Looks for the best plan for one window after another.

    Attributes:
        task: What to optimise.
        path: Configurations to follow.
        score: What is to be least; `Solution.cost` leaves out what is fixed by the
            number of stages.
        coarse: Stratified plans to start from.
        report: Told how much of the work is done, from 0 to 1.
        hurried: Whether the first solution that is found will do, as after Ctrl-C.
        without: Whether inequalities that may be violated are left out for now.
    """

    task: Task
    path: Path
    score: Score
    coarse: Coarse | None = None
    report: Report = lambda done: None
    hurried: bool = False
    without: bool = False
    _best: Solution | None = None
    _guesses: dict[Trial, Solution | None] = field(default_factory=dict)
    _tried: set[Trial] = field(default_factory=set)
    _left: float = 1.0

    def __post_init__(self) -> None:
        self.programs = Programs(self.task, self.path)
        without = Programs(self.task.relaxed, self.path)
        self._relaxed = without if self._relaxes else self.programs

    def solve(self, window: Window, count: int) -> Solution | None:
        """The best that keeps the tolerances, or else the nearest to that.

        Args:
            window: The part of the path.
            count: Number of stages to begin with.

        Raises:
            BudgetError: If the time is over before a plan is found.
        """
        self._left = 1.0
        self._guesses.clear()
        self._best, self.without = None, self._relaxes
        try:
            self._explore_both(window, count)
        except (KeyboardInterrupt, BudgetError) as stop:
            if self.without or self._width_of(self._best) > KEPT:
                raise  # nothing is found
            if isinstance(stop, BudgetError) and window.ends[1] < 1.0:
                raise
            if isinstance(stop, KeyboardInterrupt):
                if type(stop) is not KeyboardInterrupt:
                    raise  # there is no time to go on
                answer(stop)
            self.hurried = True
        return self._best

    def _explore_both(self, window: Window, count: int) -> None:
        few = 0 if window.begins else round(count / STRIDE**2)
        self._tried.clear()
        count = self._fewest(window, few, count)
        if self.without:
            if self._width_of(self._best) > KEPT:
                return
            self._best, self.without = None, False
            self._tried.clear()
            count = self._fewest(window, count - 1, count)
        if self._width_of(self._best) <= KEPT:
            self._improve(window, count)

    def _fewest(self, window: Window, few: int, count: int) -> int:
        """Find the fewest stages that do, if there are any; more than `few` of them."""
        while (width := self._width_found(window, count)) > KEPT:
            if count >= MOST:
                return count
            growth = np.clip(1 + STEEPNESS * (width - 1), STRIDE, 2.0)
            few, count = count, min(max(count + 1, round(count * growth)), MOST)
        while count - few > max(1, count * (STRIDE - 1)) and not self.hurried:
            middle = (few + count) // 2
            if self._width(window, middle, ROUGHLY) <= KEPT:
                count = middle
            else:
                few = middle
        return count

    def _width_found(self, window: Window, count: int) -> float:
        """Least width of a number of stages, from more guesses if few lead nowhere."""
        width = self._width(window, count, ROUGHLY)
        return width if width < np.inf else self._width(window, count, CLOSELY)

    def _improve(self, window: Window, count: int) -> None:
        """Try more stages until they do no better."""
        worse = 0
        while worse < WORSE and count <= MOST and not self.hurried:
            before = self._least()
            self._width(window, count, CLOSELY)
            worse = 0 if self._least() < BETTER * before else worse + 1
            count = max(count + 1, round(count * STRIDE))

    def _width(self, window: Window, count: int, attempts: int) -> float:
        """Least width found for a number of stages; keeps the best solution."""
        again = self._relaxes and not self.without
        any_first = window.begins and (count <= BOTH or again)
        attempts = min(max(1, attempts // 2), FEW) if again else attempts
        turns = len(self.task.stages) if any_first else 1
        least = np.inf
        for first in range(window.first, window.first + turns):
            cycle = [self.task.stage(first + k) for k in range(len(self.task.stages))]
            starts = guesses(cycle, count, window.ends, self.coarse)
            for number, strokes in enumerate(islice(starts, attempts)):
                trial = count, first, number
                if trial in self._tried:
                    continue
                self._tried.add(trial)
                here = self._solved(window, trial, strokes)
                self._keep(here)
                self._worked(window)
                least = min(least, self._width_of(here))
                if least <= KEPT and self.hurried:
                    return least
        return float(least)

    def _solved(self, window: Window, trial: Trial, strokes: Array) -> Solution | None:
        """The solution of a trial in the search's phase."""
        if trial not in self._guesses:
            program = self._relaxed(*trial[:2])
            tick()
            guess = program.guess(strokes, window.start, window.ends)
            self._guesses[trial] = program.solve(guess, window.ends, window.goal)
        relaxed = self._guesses[trial]
        if self.without or not self._relaxes:
            return relaxed
        if relaxed is None or relaxed.width > KEPT or self._hopeless(relaxed):
            return None
        tick()
        guess = replace(relaxed, width=np.inf)  # far inside of a wide corridor
        found = self.programs(*trial[:2]).solve(guess, window.ends, window.goal)
        # what is left of the tolerances at the steps is no licence to violate the rest
        return found and replace(found, width=found.width / TIGHTER)

    def _hopeless(self, relaxed: Solution) -> bool:
        """Whether more inequalities would only add to a score that is no better."""
        good = self._width_of(self._best) <= KEPT
        return good and self.score(relaxed) >= self._least()

    def _keep(self, found: Solution | None) -> None:
        """Remember a solution that is better, or nearer where none is good."""
        best = self._best
        if found is None or best is None:
            self._best = best or found
        elif best.width > KEPT:
            self._best = min(best, found, key=lambda solution: solution.width)
        elif found.width <= KEPT:
            self._best = min(best, found, key=self.score)
        if found is None or found is not self._best or found.width > KEPT:
            return
        if not self.without:
            stages, begin = len(found.strokes), float(found.places[0])
            tick(f"{stages} stages from {begin:.0%} of the path on")

    @property
    def _relaxes(self) -> bool:
        """Whether some inequalities are left out at first."""
        return self.task.relaxed is not self.task

    @staticmethod
    def _width_of(found: Solution | None) -> float:
        return found.width if found else np.inf

    def _least(self) -> float:
        return self.score(self._best) if self._best else np.inf

    def _worked(self, window: Window) -> None:
        """Report what is done, of an amount of work that nobody knows beforehand."""
        self._left *= WORKED
        begin, end = window.ends
        self.report(begin + (end - begin) / 2 * (1.0 - self._left))
