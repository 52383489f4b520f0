"""The search for the best plan along a whole path, window by window.

A long path is divided into windows: a window is solved, the first half of its solution
is kept, and the next window begins there. The work therefore grows in proportion to the
length of the path.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.errors import BoundError
from planner.numerics.arrays import Array
from planner.optimisation.guesses import Coarse
from planner.optimisation.requirements import TIGHTER, Demands
from planner.optimisation.task import Solution, Task
from planner.optimisation.windows import (
    KEPT,
    Report,
    Score,
    Window,
    WindowSearch,
)
from planner.planning.paths import Path
from planner.support.stopping import unlimited

FEWEST, MANY = 3, 32  # stages that the search begins with, at least and at most
BEGIN = 10.0  # stages that it begins with, for each unit that a stroke moves by
LONGEST = 15.0  # window at first, in units that a stroke moves by
SHORTEST = 0.05  # window at last, likewise
NARROWER = 16.0  # largest part of a window that is given up at once


@dataclass
class Search:
    """Looks for the best plan of a task along a path.

    Attributes:
        task: What to optimise.
        path: Configurations to follow.
        score: What is to be least.
        coarse: Stratified plans to start from.
        report: Told how much of the work is done, from 0 to 1.
    """

    task: Task
    path: Path
    score: Score
    coarse: Coarse | None = None
    report: Report = lambda done: None

    def __post_init__(self) -> None:
        self._windows = WindowSearch(
            self.task, self.path, self.score, self.coarse, lambda d: self.report(d)
        )

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
            window = Window(here, ends, self.path(1.0) if last else None, first)
            found = self._windows.solve(window, count)
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
            first = done[-1].first + len(done[-1].strokes)
            self.report(place)
        return done

    def again(
        self, solution: Solution, goal: Array, demands: Demands
    ) -> Solution | None:
        """A solution found before, solved again from where it is.

        Args:
            solution: To start from.
            goal: State to end in, shape (n,).
            demands: What is asked of each of its stages in addition.

        Returns:
            The solution; None if there is none that keeps the tolerances nearby.
        """
        program = self._windows.programs(len(solution.strokes), solution.first)
        ends = float(solution.places[0]), float(solution.places[-1])
        with unlimited():
            for near in (True, False):
                found = program.solve(solution, ends, goal, demands, near)
                if found and found.width <= KEPT:
                    return found
        return None

    def _length(self) -> float:
        """Length of the path in units that a stroke moves by."""
        points = self.path.at(np.linspace(0.0, 1.0, 201))[:, self.task.moved]
        steps = np.abs(np.diff(points, axis=0)) / self.task.sizes(self.path(0.0))
        return max(float(steps.max(axis=1).sum()), 1e-9)

    def _refusal(self, window: Window, found: Solution | None) -> BoundError:
        """Says which tolerances were kept, at most stages on the shortest window."""
        relaxed = [i.name for i in self.task.inequalities if i.relaxed]
        names = " and ".join([] if self._windows.without else relaxed)
        if found is None:
            remedy = (
                f"ask for less {names}"
                if names
                else "take a path that the joint ranges allow"
            )
            return BoundError(
                f"no plan was found along the path, whatever its tolerances, at "
                f"{window.ends[0]:.0%} of it; {remedy}"
            )
        width = found.width * TIGHTER if names else found.width
        kept = " and ".join(f"{width * t.most:.3g}" for t in self.task.tolerances)
        asked = " and ".join(f"{t.most:.3g}" for t in self.task.tolerances)
        lack = (width - TIGHTER) * self.task.unit(self.path(0.0))
        lacking = f", and its {names} may lack {lack:.3g}" if names else ""
        return BoundError(
            f"no plan was found within {asked} of the path at {window.ends[0]:.0%} of "
            f"it; the nearest found there keeps {kept}{lacking}"
        )


def _first_count(length: float) -> int:
    """Stages to begin with, of a window in units that a stroke moves by."""
    return int(np.clip(BEGIN * length, FEWEST, MANY))
