"""The search for the best plan along a whole path, window by window.

A long path is divided into windows: a window is solved, the first half of its solution
is kept, and the next window begins there. The work therefore grows in proportion to the
length of the path.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from planner.errors import BoundError, BudgetError, message
from planner.numerics.arrays import Array
from planner.optimisation.constraints import CHECKED_SHARE, Margins
from planner.optimisation.task import Solution, Task
from planner.optimisation.windows import KEPT_WIDTH, Window, WindowSearch
from planner.support.stopping import unlimited

FEWEST, MANY = 3, 32  # stages that the search begins with, at least and at most
FIRST_WINDOW = 15.0  # length of the first window, in units of a stroke's length
LAST_WINDOW = 0.05  # shortest window that is tried, likewise
LARGEST_CUT = 16.0  # factor by which a window is shortened at once


@dataclass
class Search(WindowSearch):
    """Search for the best plan of a task along a whole path.

    Where it is a single window, `found` has the best plans for tolerances from the
    rounded one on, with their tasks.
    """

    found: list[tuple[Task, Solution]] = field(default_factory=list)

    def run(self) -> list[Solution]:
        """Consecutive solutions from the start of the path to its goal.

        Ctrl-C, or the end of the time to plan in, ends the search once a plan is found.
        A `BoundError` says which tolerances would be kept. The search is made for the
        next rounded tolerance, and its best plans are then solved for the given one.
        """
        given = self.path, self.score, self.coarse, self.report, self.hops
        try:
            rounded = Search(self.task.rounded, *given)
            done = rounded._along(self.task.rungs)
            self.found, self.hurried = rounded.found, rounded.hurried
            return done
        except BoundError:
            return self._along(())

    def _along(self, rungs: Sequence[Task]) -> list[Solution]:
        """Window after window, solved at last for tolerances up to the task's own."""
        here, place, first = self.path(0.0), 0.0, 0
        points = self.path.at(np.linspace(0.0, 1.0, 201))[:, self.task.moved]
        steps = np.abs(np.diff(points, axis=0)) / self.task.sizes(here)
        length = max(float(steps.max(axis=1).sum()), 1e-9)  # in those of strokes
        done = list[Solution]()
        width = min(1.0, FIRST_WINDOW / length)
        count = _first_count(width * length)
        while place < 1.0:
            last = place + 1.01 * width >= 1.0
            ends = (place, 1.0 if last else place + width)
            window = Window(here, ends, self.path(1.0) if last else None, first)
            found = self.solve(window, count)
            if found is None or found.width > KEPT_WIDTH:
                width /= np.clip(found.width**2 if found else 2.0, 2.0, LARGEST_CUT)
                if width * length < LAST_WINDOW:
                    raise self._refusal(window, found)
                count = _first_count(width * length)
                continue
            fitted = [found]
            with suppress(BudgetError):  # larger tolerances can do without
                fitted = self.fitted(window, rungs) or fitted
            found = fitted[-1]
            if last and not done:  # fewer plans than tasks where the time is over
                self.found = list(zip((self.task, *rungs), fitted, strict=False))
            count = len(found.strokes)
            done.append(found if last else found.until(float(np.mean(ends))))
            here, place = done[-1].states[-1], 1.0 if last else done[-1].places[-1]
            first = done[-1].first + len(done[-1].strokes)
            self.report(place)
        return done

    def again(
        self, solution: Solution, goal: Array, margins: Margins
    ) -> Solution | None:
        """A solution again, for a goal and with margins; None if none keeps them."""
        program = self.programs(len(solution.strokes), solution.first)
        ends = float(solution.places[0]), float(solution.places[-1])
        with unlimited():
            for near in (True, False):
                found = program.solve(solution, ends, goal, margins, near)
                if found and found.width <= KEPT_WIDTH:
                    return found
        return None

    def _refusal(self, window: Window, found: Solution | None) -> BoundError:
        """The error that says which tolerances the narrowest solution keeps."""
        relaxed = [i.name for i in self.task.inequalities if i.relaxed]
        names = " and ".join([] if self.without_soft else relaxed)
        if found is None:
            other = "take a path that the joint ranges allow"
            way_out = f"ask for less {names}" if names else other
            facts = {"place": window.ends[0], "way_out": way_out}
            return BoundError(message("no_window", **facts))
        width = found.width * CHECKED_SHARE if names else found.width
        kept = " and ".join(f"{width * t.most:.3g}" for t in self.task.tolerances)
        asked = " and ".join(f"{t.most:.3g}" for t in self.task.tolerances)
        lack = (width - CHECKED_SHARE) * self.task.unit(self.path(0.0))
        lacking = f", and its {names} may lack {lack:.3g}" if names else ""
        facts = {"asked": asked, "place": window.ends[0], "kept": kept + lacking}
        return BoundError(message("too_near", **facts))


def _first_count(length: float) -> int:
    """Number of stages to begin with, for a window in units of a stroke's length."""
    return int(np.clip(10.0 * length, FEWEST, MANY))
