"""The vector of unknowns of the nonlinear program, with its bounds.

The vector holds, in this order, the states between stages, the places on the path, the
forward and backward parts of the strokes and of the recoveries, the durations of stages
whose recoveries overlap their strokes, and the width of the corridor in tolerances. A
stroke has one nonnegative unknown for each direction, so that the cost counts its
length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.solver import Expression, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task

UNLIMITED_STROKE = 2.0  # longest stroke without limits, relative to the path's size
GUESSED_WIDTH = 4.0  # largest width of the corridor, in tolerances, of a guess


@dataclass(frozen=True)
class Unknowns:
    """The vector of unknowns for a given number of stages."""

    task: Task
    first: int  # number in the cycle of the first stage
    count: int  # of the stages
    size: float  # largest extent of the path in a coordinate

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """All stages in time order."""
        return tuple(self.task.stage(self.first + k) for k in range(self.count))

    @property
    def widths(self) -> int:
        """Number of unknowns for the width of the corridor.

        With soft constraints each stage has its own, and all are constrained to be
        equal: one unknown in thousands of rows would make the matrices dense.
        """
        return self.count if self.task.relaxed is not self.task else 1

    def symbols(self) -> tuple[Expression, ...]:
        """Symbols of the parts, in their order in the vector."""
        ca, task, count = solver(), self.task, self.count
        shapes = {
            "states": (len(task.moved), count + 1),
            "places": (1, count + 1),
            "forward": (1, count),
            "backward": (1, count),
            "up": (task.most_recoveries, count),
            "down": (task.most_recoveries, count),
            "times": (1, count if task.overlapped else 0),
            "width": (1, self.widths),
        }
        return tuple(ca.MX.sym(name, *shape) for name, shape in shapes.items())

    def packed(self, solution: Solution) -> Array:
        """The vector of a solution; a guess has a wide corridor."""
        parts = [solution.states[:, self.task.moved].ravel(), solution.places]
        for amounts in (solution.strokes, solution.recoveries.ravel()):
            parts += [np.maximum(amounts, 0.0), np.maximum(-amounts, 0.0)]
        if self.task.overlapped:
            parts.append(np.abs(solution.strokes))
        parts.append(np.full(self.widths, min(solution.width, GUESSED_WIDTH)))
        return np.concatenate(parts)

    def unpacked(self, values: Array, cost: float, start: Array) -> Solution:
        """The solution of a vector."""
        n, count, wide = len(self.task.moved), self.count, self.task.most_recoveries
        sizes = [n * (count + 1), count + 1, count, count, wide * count, wide * count]
        states, places, *signed = np.split(values, np.cumsum(sizes))[:6]
        whole = np.tile(start, (count + 1, 1))
        whole[:, self.task.moved] = states.reshape(count + 1, n)
        recoveries = (signed[2] - signed[3]).reshape(count, wide)
        strokes, width = signed[0] - signed[1], float(values[-1])
        return Solution(self.first, strokes, recoveries, whole, places, cost, width)

    def bounds(
        self,
        start: Array,
        places: tuple[float, float],
        goal: Array | None,
        narrowest: float,
    ) -> tuple[Array, Array]:
        """Lower and upper bounds of the vector.

        The motion leads from a state (n,) to a goal likewise, if there is one, between
        two places on the path. The corridor has a smallest width, in tolerances.
        """
        count, wide, moved = self.count, self.task.most_recoveries, self.task.moved
        spans = [self.task.limits.get(i, (-np.inf, np.inf)) for i in moved]
        states = np.tile(np.array(spans), (count + 1, 1, 1))
        states[0] = start[moved, None]
        if goal is not None:
            states[-1] = goal[moved, None]
        along = np.tile(np.array(places), (count + 1, 1))
        along[0], along[-1] = places
        here = [0 if self.task.centred else len(s.recoveries) for s in self.stages]
        free = np.where(np.arange(wide) < np.array(here)[:, None], np.inf, 0.0)
        most = [self.longest, self.longest, free.ravel(), free.ravel()]
        times = np.full(count if self.task.overlapped else 0, np.inf)
        amounts, width = np.concatenate([*most, times]), np.full(self.widths, narrowest)
        widest = np.full(self.widths, np.inf)
        high = [states[..., 1].ravel(), along[:, 1], amounts, widest]
        low = [states[..., 0].ravel(), along[:, 0], np.zeros(len(amounts)), width]
        return np.concatenate(low), np.concatenate(high)

    def centred(self, strokes: Array, start: Array) -> tuple[Array, Array]:
        """Strokes clipped to their range, and recoveries that centre each on zero."""
        strokes = np.clip(strokes, -self.longest, self.longest)
        amounts = np.zeros((self.count, self.task.most_recoveries))
        rates = [self.task.rates(stage) for stage in self.stages]
        now = start.copy()
        for k, stage in enumerate(self.stages):
            for j, recovery in enumerate(() if self.task.centred else stage.recoveries):
                i = recovery.coordinate
                later = (m for m in range(k + 1, self.count) if i in rates[m])
                targets = (-strokes[m] * rates[m][i] / 2 for m in later)
                target = next(targets, start[i])
                amounts[k, j] = (target - now[i]) / recovery.rate
                now[i] = target
            for i, rate in rates[k].items():
                now[i] += rate * strokes[k]
        return strokes, amounts

    @cached_property
    def longest(self) -> Array:
        """Longest stroke of every stage, shape (count,)."""
        known = dict[Stage, float]()
        for stage in self.task.stages:
            unlimited = UNLIMITED_STROKE * max(1.0, self.size)
            known[stage] = unlimited if stage.stroke else 0.0
            for i, rate in self.task.rates(stage).items():
                low, high = self.task.limits.get(i, (-np.inf, np.inf))
                span = 2 * min(high, -low) if self.task.centred else high - low
                known[stage] = min(known[stage], span / abs(rate))
        return np.array([known[stage] for stage in self.stages])
