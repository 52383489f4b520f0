"""A search of windows without programs: solutions and what leads to them."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from planner.optimisation.windows import Window, WindowSearch

START = np.zeros(2)
WHOLE = Window(START, (0.0, 1.0), START, 0)
LATER = Window(START, (0.2, 0.6), None, 3)
LAST = Window(START, (0.2, 1.0), START, 3)


@dataclass(frozen=True, eq=False)
class Found:
    """A solution of so many stages; its hops lead to itself."""

    cost: float = 1.0
    width: float = 1.0
    count: int = 4
    first: int = 0
    hopped_by: list = field(default_factory=list)

    @property
    def strokes(self):
        """As many as there are stages."""
        return np.zeros(self.count)

    @property
    def places(self):
        """Those of the whole solution's ends."""
        return np.array([0.25, 1.0])

    def hopped(self, turn, rng):
        """The solution itself; the turn is noted."""
        self.hopped_by.append(turn)
        return self


def searching(soft=False, **changes):
    """A search of a cycle of two stages, with or without soft constraints."""
    task = SimpleNamespace(stages=("a", "b"), stage=lambda k: "ab"[k % 2])
    task.relaxed = SimpleNamespace(stages=("a", "b")) if soft else task
    reported = []
    search = WindowSearch(
        task, None, lambda s: s.cost, report=reported.append, **changes
    )
    search.reported, search.without_soft = reported, soft
    return search


class Solved:
    """Programs that give one solution after another; they note what they are asked."""

    def __init__(self, *solutions):
        self.solutions, self.asked, self.near = list(solutions), [], []

    def __call__(self, count, first):
        """The programs, as one of them."""
        self.asked.append((count, first))
        return self

    def guess(self, strokes, start, ends):
        """A guess, in an endless corridor."""
        return Found(count=len(strokes), width=np.inf)

    def solve(self, guess, ends, goal, near=None):
        """The next solution."""
        self.guesses = [*getattr(self, "guesses", []), guess]
        self.near.append(near)
        return self.solutions.pop(0)
