"""The task of an optimisation, and a solution of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar, cast

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.corridor import Tolerance
from planner.optimisation.solver import Expression
from planner.optimisation.stages import Stage, swept
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

PER_DECADE = 16  # tolerances that a search is made for
FINER = 16  # times as many, for which its plans are solved again
ROUNDING = 1e-9  # of their logarithms
CHEAP = 0.01  # cost of a recovery where strokes alone are to be short
F = TypeVar("F", bound=Callable[..., object])


@dataclass(frozen=True)
class Inequality:
    """Constraint that expressions are not negative at the ends of every stage.

    `expressions` maps a stage and the n entries of a state to CasADi's expressions.
    `lack` is the largest violation along flows in segments, between the ends of stages
    too, in their unit; 0 if there is none. A constraint that is `relaxed` is soft:
    where the tolerances cannot be kept, it may be violated as well. First solutions
    leave soft constraints out, because they are expensive.
    """

    name: str  # of the constrained quantity, such as "clearance", for messages
    expressions: Callable[[Stage, Sequence[Expression]], Sequence[Expression]]
    lack: Callable[[Sequence[Sequence[Flow]]], float] = lambda segments: 0.0
    relaxed: bool = False


@dataclass(frozen=True)
class Task:
    """Optimisation problem: fields, stages, cost, tolerances and constraints.

    A task is `centred` if the legs are repositioned before every stroke so that it is
    centred on zero; these recoveries are added to the solution later.
    """

    system: StratifiedSystem
    stages: tuple[Stage, ...]  # the cycle
    tolerances: tuple[Tolerance, ...]  # the first is of the position
    limits: Mapping[int, tuple[float, float]] = field(default_factory=dict)  # by index
    price: Mapping[str, float] = field(default_factory=dict)  # of a unit of each field
    overlapped: bool = False  # whether recoveries take place during strokes
    centred: bool = False
    inequalities: tuple[Inequality, ...] = ()
    built: dict[object, object] = field(default_factory=dict, compare=False, repr=False)

    def stage(self, number: int) -> Stage:
        """The stage with a number, counted through the repeated cycle."""
        return self.stages[number % len(self.stages)]

    @cached_property
    def moved(self) -> list[int]:
        """Coordinates that are unknowns of the program."""
        stages = self.stages if self.centred else ()
        free = {r.coordinate for stage in stages for r in stage.recoveries}
        return [i for i in swept(self.system, self.stages) if i not in free]

    @cached_property
    def relaxed(self) -> "Task":
        """The task without soft constraints."""
        strict = tuple(i for i in self.inequalities if not i.relaxed)
        same = strict == self.inequalities
        return self if same else replace(self, inequalities=strict)

    @cached_property
    def rounded(self) -> "Task":
        """The task with the tolerance of the position rounded down, to 16 a decade.

        A search for it finds the same stages for all tolerances that are rounded to it,
        so that a larger one does not give a longer plan.
        """
        return self._rounded_to(PER_DECADE)[0]

    @cached_property
    def rungs(self) -> "tuple[Task, ...]":
        """The task with finer rounded tolerances, from beyond `rounded` to its own."""
        return tuple(self._rounded_to(PER_DECADE * FINER)[1:])

    def _rounded_to(self, count: int) -> "list[Task]":
        """The task with tolerances rounded to so many a decade, from `rounded` on."""
        position, *others = self.tolerances
        if not np.isfinite(position.most):
            return [self]
        own = np.log10(position.most) + ROUNDING
        first = np.floor(own * PER_DECADE) * (count // PER_DECADE)
        steps = np.arange(first, np.floor(own * count) + 1) / count
        least = [Tolerance(position.coordinates, float(10.0**step)) for step in steps]
        return [replace(self, tolerances=(most, *others)) for most in least]

    @property
    def most_recoveries(self) -> int:
        """Largest number of recoveries of a stage."""
        return max(len(stage.recoveries) for stage in self.stages)

    def cost(self, name: str) -> float:
        """Cost of one unit of a field."""
        return self.price.get(name, 1.0)

    def rates(self, stage: Stage) -> dict[int, float]:
        """Constant rates of coordinates along a stage's stroke, by index."""
        column = self.system.fields[stage.stroke] if stage.stroke else ()
        steady = [(i, entry) for i, entry in enumerate(column) if entry.is_number]
        return {i: float(entry) for i, entry in steady if entry != 0}

    def sizes(self, start: Array) -> Array:
        """Typical change of each unknown coordinate by a stroke of one unit."""
        fields = [stage.stroke for stage in self.stages if stage.stroke]
        columns = [self.system.compiled(name).velocity(start) for name in fields]
        sizes = np.abs(columns).max(axis=0)
        for tolerance in self.tolerances:
            group = list(tolerance.coordinates)
            sizes[group] = sizes[group].max()
        return np.asarray(np.where(sizes > 0, sizes, 1.0)[self.moved])

    def unit(self, start: Array) -> float:
        """The smallest of these changes, by which inequalities are scaled."""
        return float(self.sizes(start).min())


def built_once(build: F) -> F:
    """Make a function build the same for all tasks that differ in tolerances alone."""

    def built(task: Task, stage: Stage, start: Array, *more: object) -> object:
        key = build, stage, start.tobytes(), more, task.inequalities
        if key not in task.built:
            task.built[key] = build(task, stage, start, *more)
        return task.built[key]

    return cast("F", built)


@dataclass(frozen=True, eq=False)
class Solution:
    """Strokes and recoveries of consecutive stages."""

    first: int  # number in the cycle of the first stage
    strokes: Array  # shape (N,)
    recoveries: Array  # amounts, as many as any stage has, shape (N, R)
    states: Array  # at both ends of every stage, shape (N + 1, n)
    places: Array  # on the path, from 0 to 1, that belong to them, shape (N + 1,)
    cost: float
    width: float  # least of a corridor with the motion, in tolerances; inf for a guess

    @classmethod
    def joined(cls, parts: "Sequence[Solution]") -> "Solution":
        """One solution of several, each of which begins where the last one ends."""
        begin, *rest = parts
        return cls(
            first=begin.first,
            strokes=np.concatenate([part.strokes for part in parts]),
            recoveries=np.vstack([part.recoveries for part in parts]),
            states=np.vstack([begin.states, *(part.states[1:] for part in rest)]),
            places=np.concatenate([begin.places, *(part.places[1:] for part in rest)]),
            cost=sum(part.cost for part in parts),
            width=max(part.width for part in parts),
        )

    def rearranged(self, order: Sequence[int], strokes: Array) -> "Solution":
        """A guess with some of the stages in another order and with other strokes.

        Stages that are repeated in the order recover nothing the second time.
        """
        index = np.array(order, dtype=int)
        ends = np.append(0, index + 1)
        repeated = np.array([k in order[:i] for i, k in enumerate(order)])
        return replace(
            self,
            strokes=strokes,
            recoveries=np.where(repeated[:, None], 0.0, self.recoveries[index]),
            states=self.states[ends],
            places=np.maximum.accumulate(self.places[ends]),
        )

    def hopped(self, turn: int, rng: np.random.Generator) -> "Solution":
        """A guess with a turn of the cycle moved, inserted or removed at random.

        The stages that stay keep their strokes, recoveries and states. The solver
        closes the gaps, so that most of the plan is left as it was.
        """
        order = list(range(len(self.strokes)))
        change = rng.choice(["move", "insert", "remove"])
        if change == "insert" or len(order) <= turn:
            k = int(rng.integers(len(order) + 1))
            order[k:k] = [max(k - 1, 0)] * turn
            strokes = self.strokes[order]
            strokes[k : k + turn] = 0.3 * np.abs(strokes).max() * rng.normal(size=turn)
            return self.rearranged(order, strokes)
        k = int(rng.integers(len(order) - turn + 1))
        moved = order[k : k + turn]
        del order[k : k + turn]
        if change == "move":
            k = int(rng.integers(len(order) + 1))
            order[k:k] = moved
        return self.rearranged(order, self.strokes[order])

    def until(self, place: float) -> "Solution":
        """The stages up to the first that ends beyond a place on the path."""
        count = int(np.searchsorted(self.places[1:-1], place)) + 1
        return replace(
            self,
            strokes=self.strokes[:count],
            recoveries=self.recoveries[:count],
            states=self.states[: count + 1],
            places=self.places[: count + 1],
        )
