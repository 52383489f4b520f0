"""The task of an optimisation, and a solution of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.corridor import Tolerance
from planner.optimisation.solver import Expression
from planner.optimisation.stages import Stage, swept
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem


def _none(segments: Sequence[Sequence[Flow]]) -> float:
    return 0.0


@dataclass(frozen=True)
class Inequality:
    """Constraint that expressions are not negative at the ends of every stage.

    Attributes:
        name: Name of the constrained quantity, such as "clearance", for messages.
        expressions: Maps a stage and the n entries of a state to CasADi's expressions.
        lack: Largest violation along flows in segments, between the ends of stages
            too, in the unit of the expressions; 0 if there is none.
        relaxed: Whether the constraint is soft: where the tolerances cannot be kept,
            it may be violated as well. First solutions leave soft constraints out,
            because they are expensive.
    """

    name: str
    expressions: Callable[[Stage, Sequence[Expression]], Sequence[Expression]]
    lack: Callable[[Sequence[Sequence[Flow]]], float] = _none
    relaxed: bool = False


@dataclass(frozen=True)
class Task:
    """Optimisation problem: fields, stages, cost, tolerances and constraints.

    Attributes:
        system: System whose fields are followed.
        stages: Cycle of stages.
        tolerances: Largest deviations from the path; the first is of the position.
        limits: Lowest and highest value of coordinates, by index.
        price: Cost of one unit of each field, such as its time; 1 if not given.
        overlapped: Whether recoveries take place during strokes.
        centred: Whether the legs are repositioned before every stroke so that it is
            centred on zero; these recoveries are added to the solution later.
        inequalities: Further constraints.
    """

    system: StratifiedSystem
    stages: tuple[Stage, ...]
    tolerances: tuple[Tolerance, ...]
    limits: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    price: Mapping[str, float] = field(default_factory=dict)
    overlapped: bool = False
    centred: bool = False
    inequalities: tuple[Inequality, ...] = ()

    def stage(self, number: int) -> Stage:
        """The stage with a number, counted through the repeated cycle."""
        return self.stages[number % len(self.stages)]

    @cached_property
    def moved(self) -> list[int]:
        """Coordinates that are unknowns of the program."""
        every = swept(self.system, self.stages)
        if not self.centred:
            return list(every)
        free = {r.coordinate for stage in self.stages for r in stage.recoveries}
        return [i for i in every if i not in free]

    @cached_property
    def relaxed(self) -> Task:
        """The task without soft constraints."""
        strict = tuple(i for i in self.inequalities if not i.relaxed)
        return (
            self if strict == self.inequalities else replace(self, inequalities=strict)
        )

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
        return {
            i: float(entry)
            for i, entry in enumerate(column)
            if entry.is_number and entry != 0
        }

    def sizes(self, start: Array) -> Array:
        """Typical change of each unknown coordinate by a stroke of one unit."""
        fields = [stage.stroke for stage in self.stages if stage.stroke]
        columns = [self.system.compiled(name).velocity(start) for name in fields]
        sizes = np.abs(columns).max(axis=0)
        for tolerance in self.tolerances:
            group = list(tolerance.coordinates)
            sizes[group] = sizes[group].max()
        found: Array = np.where(sizes > 0, sizes, 1.0)[self.moved]
        return found

    def unit(self, start: Array) -> float:
        """The smallest of these changes, by which inequalities are scaled."""
        return float(self.sizes(start).min())


@dataclass(frozen=True)
class Solution:
    """Strokes and recoveries of consecutive stages.

    Attributes:
        first: Number in the cycle of the first stage.
        strokes: Shape (N,).
        recoveries: Amounts of each stage's recoveries.
        states: States at both ends of every stage, shape (N + 1, n).
        places: Places on the path, from 0 to 1, that belong to them, shape (N + 1,).
        cost: Minimised cost.
        width: Smallest width of the corridor, in tolerances, that contains the motion;
            infinite for a guess.
    """

    first: int
    strokes: Array
    recoveries: tuple[Array, ...]
    states: Array
    places: Array
    cost: float
    width: float

    @classmethod
    def joined(cls, parts: Sequence[Solution]) -> Solution:
        """One solution of several, each of which begins where the last one ends."""
        places = [parts[0].places, *(part.places[1:] for part in parts[1:])]
        return cls(
            first=parts[0].first,
            strokes=np.concatenate([part.strokes for part in parts]),
            recoveries=tuple(amounts for part in parts for amounts in part.recoveries),
            states=np.vstack([parts[0].states, *(p.states[1:] for p in parts[1:])]),
            places=np.concatenate(places),
            cost=sum(part.cost for part in parts),
            width=max(part.width for part in parts),
        )

    def until(self, place: float) -> Solution:
        """The stages up to the first that ends beyond a place on the path."""
        count = int(np.searchsorted(self.places[1:-1], place)) + 1
        return replace(
            self,
            strokes=self.strokes[:count],
            recoveries=self.recoveries[:count],
            states=self.states[: count + 1],
            places=self.places[: count + 1],
        )
