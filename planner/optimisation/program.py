"""A plan with a given number of stages as a nonlinear program, by multiple shooting.

The unknowns are the strokes and recoveries of every stage, the states between stages,
and the place on the path that the motion has reached at the end of each stage. Within a
stage the state is integrated in a few steps. After each of them the motion must lie
within its tolerances of the place on the path that belongs to that moment.

The width of the corridor is an unknown too, at a high cost. A solver that begins far
from the path can thus always go on, and where no plan keeps the tolerances it ends with
the width that the corridor would need.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.dynamics import STEPS, following, stage_function
from planner.optimisation.ipopt import WARM, Ipopt
from planner.optimisation.requirements import TIGHTER, Demands, Requirements
from planner.optimisation.solver import solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task
from planner.optimisation.unknowns import Unknowns
from planner.planning.paths import Path

PARALLEL = 1e-2  # cost of what happens alongside, so that nothing moves in vain
DEAR = 1000.0  # cost of one more tolerance of width, in units of the dearest field


class Program:
    """The program for a number of stages, built once and solved from any guess.

    Args:
        task: What to optimise.
        path: Configurations to follow.
        count: Number of stages.
        first: Number in the cycle of the first one.
    """

    def __init__(self, task: Task, path: Path, count: int, first: int = 0) -> None:
        self.task, self.path = task, path
        self._start = path(0.0)
        size = np.abs(path.at(np.linspace(0.0, 1.0, 20)) - self._start).max()
        self.unknowns = Unknowns(task, first, count, float(size))
        self._stages = {
            stage: stage_function(task, stage, self._start)
            for stage in dict.fromkeys(self.unknowns.stages)
        }
        self._requirements = Requirements()
        dearest = max(task.cost(s.stroke) for s in task.stages if s.stroke)
        self._dear = DEAR * dearest
        self._program = self._built()
        self._solver = Ipopt(self._program)

    def guess(
        self, strokes: Array, start: Array, places: tuple[float, float]
    ) -> Solution:
        """A first guess from given strokes, each centred on zero, and where they lead.

        Args:
            strokes: Of every stage, shape (count,).
            start: State before the first of them, shape (n,).
            places: Where on the path the motion begins and ends.
        """
        moved, stages = self.task.moved, self.unknowns.stages
        strokes, recoveries = self.unknowns.centred(strokes, start)
        states = [start[moved]]
        for stage, stroke, amounts in zip(stages, strokes, recoveries, strict=True):
            padded = np.pad(amounts, (0, self.task.widest - len(amounts)))
            steps = self._stages[stage](states[-1], stroke, padded)
            states.append(np.array(steps)[:, -1])
        whole = np.tile(start, (len(states), 1))
        whole[:, moved] = np.array(states)
        along = np.linspace(*places, len(states))
        first = self.unknowns.first
        return Solution(first, strokes, recoveries, whole, along, np.inf, np.inf)

    def solve(
        self,
        guess: Solution,
        places: tuple[float, float],
        goal: Array | None,
        demands: Demands | None = None,
        near: bool = False,
    ) -> Solution | None:
        """The local optimum that a guess leads to; None if it leads to none.

        Where the tolerances are not kept, its `width` says what would be.

        Args:
            guess: Where to begin, its first state the start.
            places: Where on the path the motion begins and ends.
            goal: State to end in, shape (n,); None for any within the tolerances.
            demands: What is asked of each stage in addition.
            near: Whether to stay near the guess, which nearly solves the program.
        """
        start = guess.states[0]
        lowest, highest = self.unknowns.bounds(start, places, goal, TIGHTER)
        least, most = self._requirements.bounds(demands)
        compiled = self._near if near else self._solver
        found = compiled(
            x0=self.unknowns.packed(guess),
            lbx=lowest,
            ubx=highest,
            lbg=least,
            ubg=most,
        )
        if found is None:
            return None
        values = np.array(found["x"])[:, 0]
        cost = float(found["f"]) - self._dear * values[-1]
        return self.unknowns.unpacked(values, cost, start)

    @cached_property
    def _near(self) -> Ipopt:
        return Ipopt(self._program, WARM)

    def _built(self) -> dict[str, Any]:
        ca, task, asked = solver(), self.task, self._requirements
        unknown = self.unknowns.symbols()
        X, S, forward, backward, up, down, times, width = unknown
        D, A = forward - backward, up - down
        states, places, wide, numbers = (
            list[Any](),
            list[Any](),
            list[Any](),
            list[int](),
        )
        for stage in self._stages:
            k = [i for i, other in enumerate(self.unknowns.stages) if other == stage]
            after = [i + 1 for i in k]
            steps = self._stages[stage].map(len(k))(X[:, k], D[k], A[:, k])
            ends = steps[:, STEPS - 1 :: STEPS]
            scale = ca.DM(task.sizes(self._start))
            asked.add((X[:, after] - ends) / scale, 0.0, 0.0)
            for j in range(STEPS):
                last = j == STEPS - 1
                states.append(X[:, after] if last else steps[:, j::STEPS])
                places.append(S[k] + (S[after] - S[k]) * ((j + 1) / STEPS))
                end = self.unknowns.count - 1 if last else None
                numbers += [-1 if i == end else i for i in k]
            own = width[k] if width.numel() > 1 else ca.repmat(width, 1, len(k))
            wide += [own] * STEPS
            ends_of, wider = (X[:, k], X[:, after]), own - TIGHTER
            asked.inequalities(task, stage, self._start, ends_of, wider, k)
        along = following(task, self.path)
        asked.corridor(along, states, places, wide, np.array(numbers))
        asked.add(width[1:] - width[:-1], 0.0, 0.0)
        asked.add(S[1:] - S[:-1], 0.0, np.inf)
        lengths = forward + backward, up + down
        cost = self._cost(self.unknowns.stages, *lengths)
        if task.together:
            asked.times(task, self.unknowns.stages, times, *lengths)
            cost = ca.sum2(times) + PARALLEL * cost
        return {
            "x": ca.vertcat(*map(ca.vec, unknown)),
            "f": cost + self._dear * width[-1],
            "g": ca.vertcat(*asked.rows),
        }

    def _cost(self, stages: Sequence[Stage], D: Any, A: Any) -> Any:
        """Cost of all strokes and recoveries, one after another."""
        ca, task = solver(), self.task
        prices = [task.cost(s.stroke) if s.stroke else 0.0 for s in stages]
        cost = ca.dot(D, ca.DM(prices).T)
        for j in range(task.widest):
            each = [
                task.cost(s.recoveries[j].field) if j < len(s.recoveries) else 0.0
                for s in stages
            ]
            cost += ca.dot(A[j, :], ca.DM(each).T)
        return cost
