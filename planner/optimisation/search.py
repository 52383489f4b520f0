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

from planner.errors import BoundError
from planner.numerics.arrays import Array
from planner.numerics.budget import tick
from planner.numerics.interruption import answer
from planner.optimisation.guesses import Coarse, guesses
from planner.optimisation.program import Program
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path

FEWEST = 3  # stages that the search begins with
MOST = 48  # stages of a window
LONGEST = 12.0  # window at first, in units that a stroke moves by
SHORTEST = 0.05  # window at last, likewise
BOTH = 20  # stages up to which the first may be any of the cycle's
ROUGHLY = 2  # guesses that decide whether a number of stages will do
CLOSELY = 5  # guesses at numbers of stages near the fewest
STRIDE = 1.1  # from one number of stages that is tried to the next
WORSE = 2  # numbers of stages without progress, after which the search ends
WIDER = 1.25  # tolerances are widened by, when the nearest feasible ones are sought
WIDEST = 100.0

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

    def run(self) -> list[Solution]:
        """Solutions that follow each other from the path's start to its goal.

        Ctrl-C ends the search for anything better than what has been found by then;
        before a plan is found it is passed on.

        Raises:
            BoundError: If no plan keeps the tolerances; it says which would be kept.
        """
        here, place, first = self.path(0.0), 0.0, 0
        length, done, count = self._length(), list[Solution](), FEWEST
        width = min(1.0, LONGEST / length)
        while place < 1.0:
            last = place + 1.01 * width >= 1.0
            ends = (place, 1.0 if last else place + width)
            window = _Window(here, ends, self.path(1.0) if last else None, first)
            found = self._solved(window, count)
            if found is None:
                width, count = width / 2, MOST // 2
                if width * length < SHORTEST:
                    raise self._refusal(window)
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
        return program.solve(solution, ends, goal, tighter, near=True)

    def _solved(self, window: _Window, count: int) -> Solution | None:
        self._best = None
        try:
            self._explore(window, count)
        except KeyboardInterrupt as stop:
            if self._best is None or type(stop) is not KeyboardInterrupt:
                raise  # nothing is found, or there is no time to go on
            answer(stop)
            self.hurried = True
        return self._best

    def _explore(self, window: _Window, count: int) -> None:
        """Find the fewest stages that do, and try more until they do no better."""
        few = 0 if window.first == 0 else round(count / STRIDE**2)
        while not self._feasible(window, count, ROUGHLY):
            if count >= MOST:
                return
            few, count = count, min(2 * count, MOST)
        while count - few > max(1, count * (STRIDE - 1)) and not self.hurried:
            middle = (few + count) // 2
            if self._feasible(window, middle, ROUGHLY):
                count = middle
            else:
                few = middle
        worse = 0
        while worse < WORSE and not self.hurried:
            before = self._best
            self._feasible(window, count, CLOSELY)
            worse = worse + 1 if self._best is before else 0
            count = max(count + 1, round(count * STRIDE))

    def _feasible(self, window: _Window, count: int, attempts: int) -> bool:
        """Whether a number of stages does; keeps the best solution found."""
        any_first = window.first == 0 and count <= BOTH
        turns = len(self.task.stages) if any_first else 1
        found = False
        for first in range(window.first, window.first + turns):
            program = self._program(count, first)
            cycle = [self.task.stage(first + k) for k in range(len(self.task.stages))]
            starts = guesses(cycle, count, window.ends, self.coarse)
            for strokes in islice(starts, attempts):
                guess = program.guess(strokes, window.start, window.ends)
                tick()
                here = program.solve(guess, window.ends, window.goal)
                found |= here is not None
                self._keep(here)
                if found and self.hurried:
                    return True
        return found

    def _keep(self, found: Solution | None) -> None:
        if found is None:
            return
        if self._best is None or self.score(found) < self.score(self._best):
            self._best = found
            stages, begin = len(found.strokes), float(found.places[0])
            tick(f"{stages} stages from {begin:.0%} of the path on")

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

    def _refusal(self, window: _Window) -> BoundError:
        """Says which tolerances the most stages keep on a short piece of the path."""
        program = self._program(MOST, window.first)
        cycle = [
            self.task.stage(window.first + k) for k in range(len(self.task.stages))
        ]
        (strokes,) = islice(guesses(cycle, MOST, window.ends, self.coarse), 1)
        guess = program.guess(strokes, window.start, window.ends)
        wider = WIDER
        while wider < WIDEST:
            if program.solve(guess, window.ends, window.goal, wider) is not None:
                kept = " and ".join(
                    f"{wider * t.most:.3g}" for t in self.task.tolerances
                )
                asked = " and ".join(f"{t.most:.3g}" for t in self.task.tolerances)
                return BoundError(
                    f"no plan was found within {asked} of the path at "
                    f"{window.ends[0]:.0%} of it; the nearest found there keeps {kept}"
                )
            wider *= WIDER
        return BoundError(
            f"no plan was found along the path, whatever its tolerances, at "
            f"{window.ends[0]:.0%} of it; take a path that the joint ranges allow"
        )
