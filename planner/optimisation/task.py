"""The task of an optimisation and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from planner.numerics.arrays import Array
from planner.optimisation.corridor import Tolerance
from planner.optimisation.stages import Stage, swept
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

Expressions = Callable[[Stage, Sequence[Any]], Sequence[Any]]
"""Expressions over a stage and the n entries of a state."""


def _nothing(segments: Sequence[Sequence[Flow]]) -> float:
    return 0.0


@dataclass(frozen=True)
class Inequality:
    """Expressions that must not be negative in any stage.

    Attributes:
        name: What they say, such as "clearance"; used in messages.
        expressions: As a solver differentiates them, looked at as stages begin and end.
        lack: How far flows in segments come below zero on the whole way, in the same
            unit; at least 0.
        relaxed: Whether a plan that cannot keep the tolerances may violate them too.
            First solutions leave them out, because they are expensive.
    """

    name: str
    expressions: Expressions
    lack: Callable[[Sequence[Sequence[Flow]]], float] = _nothing
    relaxed: bool = False


@dataclass(frozen=True)
class Task:
    """What a plan is optimised for.

    Attributes:
        system: System whose fields are followed.
        stages: The cycle of stages.
        tolerances: How closely the path is followed; the first is of the position.
        limits: Lowest and highest value of coordinates, by index.
        price: Cost of one unit of each field, such as its time; 1 if not given.
        together: Whether recoveries happen during strokes.
        centred: Whether every stroke starts from legs set anew around zero, whose
            recoveries are added later.
        inequalities: What else must hold in every stage.
    """

    system: StratifiedSystem
    stages: tuple[Stage, ...]
    tolerances: tuple[Tolerance, ...]
    limits: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    price: Mapping[str, float] = field(default_factory=dict)
    together: bool = False
    centred: bool = False
    inequalities: tuple[Inequality, ...] = ()

    def stage(self, number: int) -> Stage:
        """The stage of a number; stages follow each other in a cycle."""
        return self.stages[number % len(self.stages)]

    @cached_property
    def moved(self) -> list[int]:
        """Coordinates that are unknowns of a program."""
        every = swept(self.system, self.stages)
        if not self.centred:
            return list(every)
        free = {r.coordinate for stage in self.stages for r in stage.recoveries}
        return [i for i in every if i not in free]

    @cached_property
    def relaxed(self) -> Task:
        """The task without the inequalities that may be violated."""
        strict = tuple(i for i in self.inequalities if not i.relaxed)
        return (
            self if strict == self.inequalities else replace(self, inequalities=strict)
        )

    @property
    def widest(self) -> int:
        """Largest number of recoveries of a stage."""
        return max(len(stage.recoveries) for stage in self.stages)

    def cost(self, name: str) -> float:
        """Cost of one unit of a field."""
        return self.price.get(name, 1.0)

    def rates(self, stage: Stage) -> dict[int, float]:
        """Coordinates that a stage's stroke moves steadily, and their rates."""
        column = self.system.fields[stage.stroke] if stage.stroke else ()
        return {
            i: float(entry)
            for i, entry in enumerate(column)
            if entry.is_number and entry != 0
        }

    def sizes(self, start: Array) -> Array:
        """What a unit of the strokes moves each unknown coordinate by, about."""
        fields = [stage.stroke for stage in self.stages if stage.stroke]
        columns = [self.system.compiled(name).velocity(start) for name in fields]
        sizes = np.abs(columns).max(axis=0)
        for tolerance in self.tolerances:
            group = list(tolerance.coordinates)
            sizes[group] = sizes[group].max()
        found: Array = np.where(sizes > 0, sizes, 1.0)[self.moved]
        return found

    def unit(self, start: Array) -> float:
        """The least that a unit of a stroke moves a coordinate by."""
        return float(self.sizes(start).min())


@dataclass(frozen=True)
class Solution:
    """Strokes and recoveries of consecutive stages.

    Attributes:
        first: Number in the cycle of the first stage.
        strokes: Shape (N,).
        recoveries: Of each stage, as many as it has.
        states: At both ends of every stage, shape (N + 1, n).
        places: Where on the path they are, from 0 to 1, shape (N + 1,).
        cost: What was minimised.
        width: Of the corridor that it keeps to, in tolerances; infinite for a guess.
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
        """Solutions that follow each other as one.

        Args:
            parts: Each begins where the one before it ends.
        """
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
        return Solution(
            first=self.first,
            strokes=self.strokes[:count],
            recoveries=self.recoveries[:count],
            states=self.states[: count + 1],
            places=self.places[: count + 1],
            cost=self.cost,
            width=self.width,
        )
