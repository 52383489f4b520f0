"""The search for the number of stages of a plan for a part of the path.

It finds the smallest number of stages that keeps the tolerances of the path, and looks
for the best plan from there upward. Soft constraints, such as clearances, make a
solution several times as expensive, and most programs with them fail from a poor first
guess, so a second search with them begins where the first has ended. Without them the
search then hops from one local optimum to the next, by seeded draws: plans do not
depend on the machine.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import islice

import numpy as np

from planner.errors import BudgetError
from planner.numerics.arrays import Array
from planner.optimisation.constraints import CHECKED_SHARE
from planner.optimisation.program import Program
from planner.optimisation.stages import Coarse, guesses
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path
from planner.support.stopping import answer, tick

MOST_STAGES = 96  # of a window
ANY_FIRST = 20  # stages up to which the first may be any of the cycle's
ROUGHLY = 2  # guesses that decide whether a number of stages is sufficient
CLOSELY = 5  # guesses at numbers of stages near the smallest
SOFT_GUESSES = 2  # guesses there with soft constraints, which cost more
STRIDE = 1.1  # ratio of numbers of stages that are tried one after another
PATIENT_FOR = 2  # numbers of stages without progress, after which the search ends
PROGRESS = 0.999  # of the least score so far, which counts as progress
KEPT_WIDTH = 1.0 + 1e-6  # of the corridor, in tolerances, that counts as keeping them
STEEPNESS = 0.8  # relative growth of the stages per tolerance of excess width
WARMTH = 1.004  # of the least score, that the plan may have from which a hop starts
FINALISTS = 4  # plans of different scores that are solved again at the end
DISTINCT = 1 + 1e-5  # ratio of their scores
SEARCHED = 0.3  # share of a window's work that precedes the hops, as reported

Report = Callable[[float], None]
Programs = Callable[[int, int], Program]
Trial = tuple[int, int, int]  # number of stages, the first of them, and of the guess


@dataclass(frozen=True, eq=False, slots=True)
class Window:
    """A part of the path, and the state in which the motion enters it."""

    start: Array  # state at its beginning, shape (n,)
    ends: tuple[float, float]  # places on the path, from 0 to 1
    goal: Array | None  # state to end in, shape (n,); None for any in the tolerances
    first: int  # number of the first stage, counted from the start of the path

    @property
    def begins(self) -> bool:
        """Whether the path begins here, so that any stage may be the first."""
        return self.ends[0] == 0.0


def programs_of(task: Task, path: Path) -> Programs:
    """Programs for a number of stages and the first of them, each built once."""
    built = cache(partial(Program, task, path))
    return lambda count, first: built(count, first % len(task.stages))


@dataclass
class WindowSearch:
    """Search for the best plan of one window after another.

    The score is the objective of a solution; `Solution.cost` lacks the part that the
    number of stages determines. `report` is called with the share of the work done.
    """

    task: Task
    path: Path
    score: Callable[[Solution], float]
    coarse: Coarse | None = None
    report: Report = lambda done: None
    hops: int = 0  # from the best plan of each window
    hurried: bool = False  # whether the first solution is accepted, as after Ctrl-C
    without_soft: bool = False  # whether soft constraints are left out at present
    _best: Solution | None = None
    _guesses: dict[Trial, Solution | None] = field(default_factory=dict)
    _tried: set[Trial] = field(default_factory=set)
    _kept_plans: list[Solution] = field(default_factory=list)
    _left: float = 1.0

    def __post_init__(self) -> None:
        self.programs = programs_of(self.task, self.path)
        without = programs_of(self.task.relaxed, self.path)
        self._relaxed = without if self._relaxes else self.programs

    def solve(self, window: Window, count: int) -> Solution | None:
        """The best solution that keeps the tolerances, or the narrowest if none does.

        The search begins with `count` stages. It raises `BudgetError` if the time is
        over before a plan is found.
        """
        self._left = 1.0
        self._guesses.clear()
        self._kept_plans.clear()
        self._best, self.without_soft = None, self._relaxes
        try:
            self._explore(window, count)
        except (KeyboardInterrupt, BudgetError) as stop:
            out_of_time = isinstance(stop, BudgetError) and window.ends[1] < 1.0
            at_once = type(stop) not in (KeyboardInterrupt, BudgetError)
            if self.without_soft or not self._kept or out_of_time or at_once:
                raise
            if isinstance(stop, KeyboardInterrupt):
                answer(stop)
            self.hurried = True
        return self._best

    def _explore(self, window: Window, count: int) -> None:
        """The first search and, with soft constraints, the second."""
        few = 0 if window.begins else round(count / STRIDE**2)
        self._tried.clear()
        count = self._fewest(window, few, count)
        if self.without_soft:
            if not self._kept:
                return
            self._best, self.without_soft = None, False
            self._tried.clear()
            count = self._fewest(window, count - 1, count)
        if self._kept:
            self._improve(window, count)
        if self._kept and not self._relaxes:
            self._hop(window)

    def _fewest(self, window: Window, few: int, count: int) -> int:
        """The fewest stages, more than `few`, that keep the tolerances, if any do."""
        while True:
            width = self._width(window, count, ROUGHLY)
            if width == np.inf:
                width = self._width(window, count, CLOSELY)
            if width <= KEPT_WIDTH:
                break
            if count >= MOST_STAGES:
                return count
            growth = np.clip(1 + STEEPNESS * (width - 1), STRIDE, 2.0)
            few, count = count, min(max(count + 1, round(count * growth)), MOST_STAGES)
        while count - few > max(1, count * (STRIDE - 1)) and not self.hurried:
            middle = (few + count) // 2
            kept = self._width(window, middle, ROUGHLY) <= KEPT_WIDTH
            few, count = (few, middle) if kept else (middle, count)
        return count

    def _improve(self, window: Window, count: int) -> None:
        """Try more stages until the score no longer improves."""
        worse = 0
        while worse < PATIENT_FOR and count <= MOST_STAGES and not self.hurried:
            before = self._least()
            self._width(window, count, CLOSELY)
            worse = 0 if self._least() < PROGRESS * before else worse + 1
            count = max(count + 1, round(count * STRIDE))

    def _hop(self, window: Window) -> None:
        """Solve again and again from a plan that is changed at random."""
        rng, here = np.random.default_rng(0), self._best
        for number in range(self.hops):
            if here is None or self.hurried:
                return
            guess = here.hopped(len(self.task.stages), rng)
            if len(guess.strokes) > MOST_STAGES:
                continue
            tick()
            program = self.programs(len(guess.strokes), guess.first)
            found = program.solve(guess, window.ends, window.goal)
            self._keep(found)
            kept = found is not None and found.width <= KEPT_WIDTH
            if found and kept and self.score(found) < WARMTH * self._least():
                here = found
            self._report(window, SEARCHED + (1 - SEARCHED) * (number + 1) / self.hops)

    def fitted(self, window: Window, rungs: Sequence[Task]) -> list[Solution]:
        """The best plans found, solved again for larger and larger tolerances."""
        found = [self._best] if self._best else []
        for number, task in enumerate(rungs):
            programs = programs_of(task, self.path)
            for plan in self._finalists() if number == 0 else found[-1:]:
                program, best = programs(len(plan.strokes), plan.first), found[-1]
                for near in (True, False):
                    tick()
                    again = program.solve(plan, window.ends, window.goal, near=near)
                    if again and again.width <= KEPT_WIDTH:
                        found.append(min(best, again, key=self.score))
                        break
            found = [*found[: number + 1], min(found[number:], key=self.score)]
        return found

    def _finalists(self) -> list[Solution]:
        """The best plans found, of different scores."""
        found = list[Solution]()
        for plan in sorted(self._kept_plans, key=self.score):
            if not found or self.score(plan) > DISTINCT * self.score(found[-1]):
                found.append(plan)
        return found[:FINALISTS]

    def _report(self, window: Window, done: float) -> None:
        """Report the share of a window's work that is done."""
        begin, end = window.ends
        self.report(begin + (end - begin) * done / (1 if end == 1.0 else 2))

    def _width(self, window: Window, count: int, attempts: int) -> float:
        """Least width found for a number of stages; the best solution is kept."""
        again = self._relaxes and not self.without_soft
        any_first = window.begins and (count <= ANY_FIRST or again)
        attempts = min(max(1, attempts // 2), SOFT_GUESSES) if again else attempts
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
                self._left *= 0.97  # the amount of work is not known beforehand
                before = SEARCHED if self.hops and not self._relaxes else 1.0
                self._report(window, before * (1.0 - self._left))
                least = min(least, here.width if here else np.inf)
                if least <= KEPT_WIDTH and self.hurried:
                    return least
        return float(least)

    def _solved(self, window: Window, trial: Trial, strokes: Array) -> Solution | None:
        """The solution of a trial, with soft constraints in the second search."""
        if trial not in self._guesses:
            program = self._relaxed(*trial[:2])
            tick()
            guess = program.guess(strokes, window.start, window.ends)
            self._guesses[trial] = program.solve(guess, window.ends, window.goal)
        relaxed = self._guesses[trial]
        if self.without_soft or not self._relaxes:
            return relaxed
        if relaxed is None or relaxed.width > KEPT_WIDTH:
            return None
        if self._kept and self.score(relaxed) >= self._least():
            return None  # no better even without soft constraints
        tick()
        guess = replace(relaxed, width=np.inf)  # far inside of a wide corridor
        found = self.programs(*trial[:2]).solve(guess, window.ends, window.goal)
        # soft constraints hold only where the corridor has its smallest width
        return found and replace(found, width=found.width / CHECKED_SHARE)

    def _keep(self, found: Solution | None) -> None:
        """Keep a better solution, or a narrower one while none keeps the tolerances."""
        best = self._best
        if found is None or best is None:
            self._best = best or found
        elif best.width > KEPT_WIDTH:
            self._best = min(best, found, key=lambda solution: solution.width)
        elif found.width <= KEPT_WIDTH:
            self._best = min(best, found, key=self.score)
        if found is None or found.width > KEPT_WIDTH or self.without_soft:
            return
        self._kept_plans.append(found)
        if found is self._best:
            stages, begin = len(found.strokes), float(found.places[0])
            tick(f"{stages} stages that begin at {begin:.0%} of the path")

    @property
    def _relaxes(self) -> bool:
        """Whether there are soft constraints."""
        return self.task.relaxed is not self.task

    @property
    def _kept(self) -> bool:
        """Whether a solution keeps the tolerances."""
        return self._best is not None and self._best.width <= KEPT_WIDTH

    def _least(self) -> float:
        return self.score(self._best) if self._best else np.inf
