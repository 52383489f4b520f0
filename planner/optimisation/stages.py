"""Stages of an optimised plan, their cycle, and first guesses of their strokes.

An optimised plan visits its strata in turn. On each stratum one field makes a stroke,
which moves the body. Other fields move a single coordinate, such as the angle of a leg
in the air, and bring it to the value that later strokes need. The columns of the fields
show which of them are strokes and which are recoveries.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain

import numpy as np

from planner.errors import PlannerError, StratumError, message
from planner.numerics.arrays import Array
from planner.systems.elements import leaves, parse
from planner.systems.fields import NumericField, VectorField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

Coarse = Callable[[float, float, int], Sequence[Flow]]
"""Flows of a stratified plan from one place on the path to another, in segments."""
ZERO_FLOW = 1e-5  # duration; an interior-point method leaves this much of no flow


@dataclass(frozen=True, slots=True)
class Recovery:
    """A field that moves one coordinate alone, at a constant rate."""

    field: str
    coordinate: int
    rate: float


@dataclass(frozen=True, slots=True)
class Stage:
    """A stay on one stratum: recoveries, then a stroke, or all of them at once."""

    stratum: str
    stroke: str  # empty where coordinates are only recovered
    recoveries: tuple[Recovery, ...]

    def flows(self, stroke: float, recoveries: Sequence[float]) -> list[Flow]:
        """Its flows in time order, without negligible ones."""
        named = [r.field for r in self.recoveries] + [self.stroke] * bool(self.stroke)
        amounts = [*recoveries[: len(self.recoveries)], stroke]
        return [
            Flow(self.stratum, name, float(amount))
            for name, amount in zip(named, amounts, strict=False)  # or no stroke
            if abs(amount) > ZERO_FLOW
        ]


def cycle(system: StratifiedSystem, elements: Sequence[str]) -> tuple[Stage, ...]:
    """The stages that an optimised plan repeats: strokes in the order of the elements.

    A stroke is a field that moves several coordinates; recoveries that its stratum does
    not allow have a stage of their own.
    """
    trees = [parse(text, system) for text in elements]
    names = list(dict.fromkeys(chain(*map(leaves, trees))))
    for name in names:
        if isinstance(system.fields[name], NumericField):
            raise StratumError(message("function_only", name=name))
    single = {name: _recovery(name, system.fields[name]) for name in system.fields}
    strokes = [name for name in names if single[name] is None]
    if not strokes:
        raise StratumError(message("no_stroke"))
    wanted = set[int]()  # coordinates that a stroke moves or depends on
    for field in (system.fields[name] for name in strokes):
        read = [i for i, s in enumerate(system.state) if s in field.free_symbols]
        wanted |= {*_moved(field), *read}
    found = [r for r in single.values() if r and r.coordinate in wanted]

    def on(stratum: str) -> tuple[Recovery, ...]:
        return tuple(r for r in found if system.stratum_of[r.field] == stratum)

    alongside = {r.coordinate for name in strokes for r in on(system.stratum_of[name])}
    stages = []
    for name in strokes:
        stratum = system.stratum_of[name]
        stages.append(Stage(stratum, name, on(stratum)))
        left = set(_moved(system.fields[name])) - alongside
        for recovery in found:
            if recovery.coordinate in left:
                left.discard(recovery.coordinate)
                stages.append(Stage(system.stratum_of[recovery.field], "", (recovery,)))
    return tuple(stages)


def swept(system: StratifiedSystem, stages: Sequence[Stage]) -> tuple[int, ...]:
    """Coordinates that flows of the stages can move, ascending."""
    moved = {r.coordinate for stage in stages for r in stage.recoveries}
    for stage in stages:
        moved |= set(_moved(system.fields[stage.stroke])) if stage.stroke else set()
    return tuple(sorted(moved))


def _recovery(name: str, field: VectorField) -> Recovery | None:
    """The field as a recovery; None if it moves several coordinates or varies."""
    if isinstance(field, NumericField):
        return None
    moved = _moved(field)
    if len(moved) != 1 or not field[moved[0]].is_number:
        return None
    return Recovery(name, moved[0], float(field[moved[0]]))


def _moved(field: VectorField) -> list[int]:
    return [i for i, entry in enumerate(field) if entry != 0]


def guesses(
    stages: Sequence[Stage], n: int, places: tuple[float, float], coarse: Coarse | None
) -> Iterator[Array]:
    """First guesses of the strokes, shape (n,), the most promising first.

    Coarse stratified plans between two places on the path, from 0 to 1, come first,
    then strokes that alternate at random. `stages` is the cycle from the first stage.
    """
    for share in (1.0, 0.5) if coarse else ():  # of the stages
        segments = max(1, int(share * (n - 1) / (2 * len(stages))))
        with suppress(PlannerError):
            flows = coarse(*places, segments) if coarse else ()
            if (found := amounts_of(stages, flows, n)) is not None:
                yield found
    rng = np.random.default_rng(0)
    for _ in range(3):  # as many backward as forward in turn, with noise
        size, half = rng.uniform(0.2, 0.6), int(rng.choice([2, 2, 4, 4, 6]))
        pattern = np.resize(np.repeat([1.0, -1.0], half), n + half)
        turned = np.roll(pattern, int(rng.integers(4 * half)))[:n]
        yield turned * size + 0.05 * rng.normal(size=n)


def amounts_of(
    stages: Sequence[Stage], flows: Sequence[Flow], count: int
) -> Array | None:
    """Strokes of a plan as amounts of consecutive stages, shape (count,).

    Recoveries are ignored. None if the strokes need more stages than there are.
    """
    amounts, k, strokes = np.zeros(count), 0, [stage.stroke for stage in stages]
    for flow in flows:
        if flow.field in strokes:
            while k < count and strokes[k % len(strokes)] != flow.field:
                k += 1
            if k >= count:
                return None
            amounts[k] += flow.duration
    return amounts
