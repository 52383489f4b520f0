"""The search for the number of stages of a plan, and for the best local optimum.

A program has a fixed number of stages. With fewer stages a plan switches contacts less
often and makes longer strokes, until the tolerances of the path can no longer be met.
The search finds the smallest number of stages that meets them, and looks for the best
plan from there upward. A long path is divided into windows: a window is solved, the
first half of its solution is kept, and the next window begins there. The work therefore
grows in proportion to the length of the path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from planner.errors import BoundError, BudgetError
from planner.numerics.arrays import Array
from planner.numerics.budget import tick, unlimited
from planner.numerics.interruption import answer
from planner.optimisation.guesses import Coarse, guesses
from planner.optimisation.program import TIGHTER, Program
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path

FEWEST = 3  # stages that the search begins with, at least
BEGIN = 10.0  # stages that it begins with, for each unit that a stroke moves by
MOST = 96  # stages of a window
LONGEST = 15.0  # window at first, in units that a stroke moves by
SHORTEST = 0.05  # window at last, likewise
BOTH = 20  # stages up to which the first may be any of the cycle's
ROUGHLY = 2  # guesses that decide whether a number of stages will do
CLOSELY = 5  # guesses at numbers of stages near the fewest
STRIDE = 1.1  # from one number of stages that is tried to the next
WORSE = 2  # numbers of stages without progress, after which the search ends
BETTER = 0.999  # of the least so far, which is progress
KEPT = 1.0 + 1e-6  # width, in tolerances, that counts as keeping them
STEEPNESS = 0.8  # growth of the stages for each tolerance that is lacking
NARROWER = 16.0  # largest part of a window that is given up at once
WORKED = 0.97  # share of a window's work that is left after each solution, as reported

Score = Callable[[Solution], float]
Report = Callable[[float], None]


@dataclass(frozen=True, eq=False, slots=True)
class _Window:
    """A part of the path, and the state in which the motion comes to it."""

    start: Array
    ends: tuple[float, float]
    goal: Array | None
    first: int  # stage, by its number since the start


@dataclass
class Search:
    """Looks for the best plan of a task along a path.

    Attributes:
        task: What to optimise.
        path: Configurations to follow.
        score: What is to be least; `Solution.cost` leaves out what is fixed by the
            number of stages.
        coarse: Stratified plans to start from.
        report: Told how much of the work is done, from 0 to 1.
        hurried: Whether the first solution that is found will do, as after Ctrl-C.
    """

    task: Task
    path: Path
    score: Score
    coarse: Coarse | None = None
    report: Report = lambda done: None
    hurried: bool = False
    _programs: dict[tuple[int, int], Program] = field(default_factory=dict)
    _best: Solution | None = None
    _tried: set[tuple[int, int, int]] = field(default_factory=set)
    _left: float = 1.0

    def run(self) -> list[Solution]:
        """Solutions that follow each other from the path's start to its goal.

        Ctrl-C, or the end of the time to plan in, ends the search for anything better
        than what has been found by then; before a plan is found it is passed on.

        Raises:
            BoundError: If no plan keeps the tolerances; it says which would be kept.
            BudgetError: If the time is over before a plan is found.
        """
        here, place, first = self.path(0.0), 0.0, 0
        length, done = self._length(), list[Solution]()
        width = min(1.0, LONGEST / length)
        count = _first_count(width * length)
        while place < 1.0:
            last = place + 1.01 * width >= 1.0
            ends = (place, 1.0 if last else place + width)
            window = _Window(here, ends, self.path(1.0) if last else None, first)
            found = self._solved(window, count)
            if found is None or found.width > KEPT:
                lacking = found.width**2 if found else 2.0
                width /= np.clip(lacking, 2.0, NARROWER)
                if width * length < SHORTEST:
                    raise self._refusal(window, found)
                count = _first_count(width * length)
                continue
            count = len(found.strokes)
            done.append(found if last else found.until(float(np.mean(ends))))
            here, place = done[-1].states[-1], 1.0 if last else done[-1].places[-1]
            first += len(done[-1].strokes)
            self.report(place)
        return done

    def again(self, solution: Solution, goal: Array, tighter: float) -> Solution | None:
        """The last solution of a plan, solved again from where it is.

        Args:
            solution: To start from.
            goal: State to end in, shape (n,).
            tighter: Part of the tolerances to keep.
        """
        program = self._program(len(solution.strokes), solution.first)
        ends = (float(solution.places[0]), 1.0)
        with unlimited():
            found = program.solve(solution, ends, goal, tighter, near=True)
        return found if found and found.width <= max(KEPT, KEPT * tighter) else None

    def _solved(self, window: _Window, count: int) -> Solution | None:
        """The best that keeps the tolerances, or else the nearest to that."""
        self._best, self._left = None, 1.0
        self._tried.clear()
        try:
            self._explore(window, count)
        except (KeyboardInterrupt, BudgetError) as stop:
            if self._best is None or self._best.width > KEPT:
                raise  # nothing is found
            if isinstance(stop, BudgetError) and window.ends[1] < 1.0:
                raise
            if isinstance(stop, KeyboardInterrupt):
                if type(stop) is not KeyboardInterrupt:
                    raise  # there is no time to go on
                answer(stop)
            self.hurried = True
        return self._best

    def _explore(self, window: _Window, count: int) -> None:
        """Find the fewest stages that do, and try more until they do no better."""
        few = 0 if window.first == 0 else round(count / STRIDE**2)
        while (width := self._width(window, count, ROUGHLY)) > KEPT:
            if count >= MOST:
                return
            growth = np.clip(1 + STEEPNESS * (width - 1), STRIDE, 2.0)
            few, count = count, min(max(count + 1, round(count * growth)), MOST)
        while count - few > max(1, count * (STRIDE - 1)) and not self.hurried:
            middle = (few + count) // 2
            if self._width(window, middle, ROUGHLY) <= KEPT:
                count = middle
            else:
                few = middle
        worse = 0
        while worse < WORSE and count <= MOST and not self.hurried:
            before = self._least()
            self._width(window, count, CLOSELY)
            worse = 0 if self._least() < BETTER * before else worse + 1
            count = max(count + 1, round(count * STRIDE))

    def _width(self, window: _Window, count: int, attempts: int) -> float:
        """Least width found for a number of stages; keeps the best solution."""
        any_first = window.first == 0 and count <= BOTH
        turns = len(self.task.stages) if any_first else 1
        least = np.inf
        for first in range(window.first, window.first + turns):
            program = self._program(count, first)
            cycle = [self.task.stage(first + k) for k in range(len(self.task.stages))]
            starts = guesses(cycle, count, window.ends, self.coarse)
            for number, strokes in enumerate(islice(starts, attempts)):
                if (count, first, number) in self._tried:
                    continue
                self._tried.add((count, first, number))
                guess = program.guess(strokes, window.start, window.ends)
                tick()
                here = program.solve(guess, window.ends, window.goal)
                self._keep(here)
                self._worked(window)
                least = min(least, here.width if here else np.inf)
                if least <= KEPT and self.hurried:
                    return least
        return float(least)

    def _keep(self, found: Solution | None) -> None:
        """Remember a solution that is better, or nearer where none is good."""
        best = self._best
        if found is None or best is None:
            self._best = best or found
        elif best.width > KEPT:
            self._best = min(best, found, key=lambda solution: solution.width)
        elif found.width <= KEPT:
            self._best = min(best, found, key=self.score)
        if found is not None and found is self._best and found.width <= KEPT:
            stages, begin = len(found.strokes), float(found.places[0])
            tick(f"{stages} stages from {begin:.0%} of the path on")

    def _least(self) -> float:
        return self.score(self._best) if self._best else np.inf

    def _worked(self, window: _Window) -> None:
        """Report what is done, of an amount of work that nobody knows beforehand."""
        self._left *= WORKED
        begin, end = window.ends
        self.report(begin + (end - begin) / 2 * (1.0 - self._left))

    def _program(self, count: int, first: int) -> Program:
        key = count, first % len(self.task.stages)
        if key not in self._programs:
            self._programs[key] = Program(self.task, self.path, *key)
        return self._programs[key]

    def _length(self) -> float:
        """Length of the path in units that a stroke moves by."""
        points = self.path.at(np.linspace(0.0, 1.0, 201))[:, self.task.moved]
        steps = np.abs(np.diff(points, axis=0)) / self.task.sizes(self.path(0.0))
        return max(float(steps.max(axis=1).sum()), 1e-9)

    def _refusal(self, window: _Window, found: Solution | None) -> BoundError:
        """Says which tolerances were kept, at most stages on the shortest window."""
        if found is None:
            return BoundError(
                f"no plan was found along the path, whatever its tolerances, at "
                f"{window.ends[0]:.0%} of it; take a path that the joint ranges allow"
            )
        kept = " and ".join(f"{found.width * t.most:.3g}" for t in self.task.tolerances)
        asked = " and ".join(f"{t.most:.3g}" for t in self.task.tolerances)
        lacking = (found.width - TIGHTER) * self.task.unit(self.path(0.0))
        closer = f", and comes up to {lacking:.3g} closer to obstacles than it may"
        kept += closer if self.task.rooms else ""
        return BoundError(
            f"no plan was found within {asked} of the path at {window.ends[0]:.0%} of "
            f"it; the nearest found there keeps {kept}"
        )


def _first_count(length: float) -> int:
    """Stages to begin with, of a window in units that a stroke moves by."""
    return int(np.clip(BEGIN * length, FEWEST, MOST))
