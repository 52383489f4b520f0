"""The nonlinear program of a plan with a given number of stages, by multiple shooting.

The unknowns are the strokes and recoveries of every stage, the states between stages,
the places on the path that belong to the ends of the stages, and the durations of those
whose recoveries overlap their strokes. After each of a few steps within a stage the
state must lie in the corridor around the place on the path that belongs to this moment.
The width of the corridor is an unknown with a high cost: the program is feasible from
any guess, and says which width is needed where no plan keeps the tolerances.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.constraints import (
    CHECKED_SHARE,
    STAGE_STEPS,
    Constraints,
    Margins,
    curve_function,
    path_distance,
    stage_function,
)
from planner.optimisation.solver import Expression, Ipopt, solver
from planner.optimisation.stages import Stage
from planner.optimisation.task import Solution, Task
from planner.planning.paths import Path

OVERLAPPED_COST = 1e-2  # weight of overlapped flows, so that none is made in vain
GUESSED_WIDTH = 4.0  # largest width of the corridor, in tolerances, of a guess


@dataclass(frozen=True)
class Unknowns:
    """The vector of unknowns for a given number of stages, with its bounds.

    A stroke has one nonnegative unknown for each direction, and so has a recovery, so
    that the cost counts their lengths.
    """

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

        With soft constraints each stage has its own, all constrained to be equal: one
        unknown in thousands of rows would make the matrices dense.
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
        self, start: Array, ends: tuple[float, float], goal: Array | None, least: float
    ) -> tuple[Array, Array]:
        """Lower and upper bounds of the vector, for a motion from a state to a goal.

        It goes between two ends on the path, in a corridor of a smallest width.
        """
        count, wide, moved = self.count, self.task.most_recoveries, self.task.moved
        spans = [self.task.limits.get(i, (-np.inf, np.inf)) for i in moved]
        states = np.tile(np.array(spans), (count + 1, 1, 1))
        states[0] = start[moved, None]
        if goal is not None:
            states[-1] = goal[moved, None]
        along = np.tile(np.array(ends), (count + 1, 1))
        along[0], along[-1] = ends
        here = [0 if self.task.centred else len(s.recoveries) for s in self.stages]
        free = np.where(np.arange(wide) < np.array(here)[:, None], np.inf, 0.0)
        most = [self.longest, self.longest, free.ravel(), free.ravel()]
        times = np.full(count if self.task.overlapped else 0, np.inf)
        amounts, width = np.concatenate([*most, times]), np.full(self.widths, least)
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
                target = next((-strokes[m] * rates[m][i] / 2 for m in later), start[i])
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
            unlimited = 2.0 * max(1.0, self.size)  # in sizes of the path
            known[stage] = unlimited if stage.stroke else 0.0
            for i, rate in self.task.rates(stage).items():
                low, high = self.task.limits.get(i, (-np.inf, np.inf))
                span = 2 * min(high, -low) if self.task.centred else high - low
                known[stage] = min(known[stage], span / abs(rate))
        return np.array([known[stage] for stage in self.stages])


class Program:
    """The program for a number of stages, built once and solved from any guess."""

    def __init__(self, task: Task, path: Path, count: int, first: int = 0) -> None:
        self.task, self.path = task, path
        start = self._start = path(0.0)
        size = np.abs(path.at(np.linspace(0.0, 1.0, 20)) - self._start).max()
        self.unknowns = Unknowns(task, first, count, float(size))
        self._stages = {s: stage_function(task, s, start) for s in self.unknowns.stages}
        dearest = max(task.cost(s.stroke) for s in task.stages if s.stroke)
        self._width_cost = 1000.0 * dearest  # of a tolerance of width
        self._constraints = Constraints()
        _, straight = curve_function(path, task.moved)
        # scalar operations take less than half of the time, but know no splines
        self._solver = Ipopt(self._built(), {"expand": straight})

    def guess(
        self, strokes: Array, start: Array, places: tuple[float, float]
    ) -> Solution:
        """A first guess: strokes (count,), each centred on zero, and their motion."""
        moved, stages = self.task.moved, self.unknowns.stages
        strokes, recoveries = self.unknowns.centred(strokes, start)
        states = [start[moved]]
        for stage, stroke, amounts in zip(stages, strokes, recoveries, strict=True):
            steps = self._stages[stage](states[-1], stroke, amounts)
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
        margins: Margins | None = None,
        near: bool = False,
    ) -> Solution | None:
        """The local optimum near a guess; None if the solver finds none.

        It begins in the guess's first state and ends in the goal, or anywhere within
        the tolerances if there is none. The solver stays `near` a good guess.
        """
        start = guess.states[0]
        lowest, highest = self.unknowns.bounds(start, places, goal, CHECKED_SHARE)
        low, high = self._constraints.bounds(margins)
        if np.count_nonzero(low == high) > np.count_nonzero(lowest < highest):
            return None  # more equations than unknowns that are free to meet them
        compiled = self._warm_solver if near else self._solver
        found = compiled(
            x0=self.unknowns.packed(guess), lbx=lowest, ubx=highest, lbg=low, ubg=high
        )
        if found is None:
            return None
        values = np.array(found["x"])[:, 0]
        cost = float(found["f"]) - self._width_cost * values[-1]
        return self.unknowns.unpacked(values, cost, start)

    @cached_property
    def _warm_solver(self) -> Ipopt:
        return self._solver.warm()

    def _built(self) -> dict[str, Expression]:
        """Unknowns x, cost f and constraints g."""
        ca, task, constraints = solver(), self.task, self._constraints
        unknown = self.unknowns.symbols()
        X, S, forward, backward, up, down, times, width = unknown
        D, A = forward - backward, up - down
        states, places = list[Expression](), list[Expression]()
        wide, numbers = list[Expression](), list[int]()
        for stage in self._stages:
            k = [i for i, other in enumerate(self.unknowns.stages) if other == stage]
            after = [i + 1 for i in k]
            steps = self._stages[stage].map(len(k))(X[:, k], D[k], A[:, k])
            ends = steps[:, STAGE_STEPS - 1 :: STAGE_STEPS]
            scale = ca.DM(task.sizes(self._start))
            constraints.add((X[:, after] - ends) / scale, 0.0, 0.0)
            for j in range(STAGE_STEPS):
                last = j == STAGE_STEPS - 1
                states.append(X[:, after] if last else steps[:, j::STAGE_STEPS])
                places.append(S[k] + (S[after] - S[k]) * ((j + 1) / STAGE_STEPS))
                end = self.unknowns.count - 1 if last else None
                numbers += [-1 if i == end else i for i in k]
            own = width[k] if width.numel() > 1 else ca.repmat(width, 1, len(k))
            wide += [own] * STAGE_STEPS
            both_ends, excess = (X[:, k], X[:, after]), own - CHECKED_SHARE
            constraints.inequalities(task, stage, self._start, both_ends, excess, k)
        distance = path_distance(task, self.path)
        constraints.corridor(distance, states, places, wide, np.array(numbers))
        constraints.add(width[1:] - width[:-1], 0.0, 0.0)
        constraints.add(S[1:] - S[:-1], 0.0, np.inf)
        lengths = forward + backward, up + down
        cost = self._cost(*lengths)
        if task.overlapped:
            constraints.durations(task, self.unknowns.stages, times, *lengths)
            cost = ca.sum2(times) + OVERLAPPED_COST * cost
        return {
            "x": ca.vertcat(*map(ca.vec, unknown)),
            "f": cost + self._width_cost * width[-1],
            "g": ca.vertcat(*constraints.rows),
        }

    def _cost(self, D: Expression, A: Expression) -> Expression:
        """Cost of all strokes and recoveries in sequence."""
        ca, task, stages = solver(), self.task, self.unknowns.stages
        prices = [task.cost(s.stroke) if s.stroke else 0.0 for s in stages]
        cost = ca.dot(D, ca.DM(prices).T)
        for j in range(task.most_recoveries):
            fields = [s.recoveries[j].field if s.recoveries[j:] else "" for s in stages]
            prices = [task.cost(name) if name else 0.0 for name in fields]
            cost += ca.dot(A[j, :], ca.DM(prices).T)
        return cost
