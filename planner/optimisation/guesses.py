"""First guesses for a program: coarse stratified plans, and randomly drawn loops."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress

import numpy as np

from planner.errors import PlannerError
from planner.numerics.arrays import Array
from planner.optimisation.stages import Stage, amounts_of
from planner.systems.flows import Flow

Coarse = Callable[[float, float, int], Sequence[Flow]]
"""Flows of a stratified plan from one place on the path to another, in segments."""

LOOPS = 3  # sizes and turns of loops that are tried
STRATIFIED = (1.0, 0.5)  # shares of the stages that coarse plans take


def guesses(
    stages: Sequence[Stage],
    count: int,
    places: tuple[float, float],
    coarse: Coarse | None,
    seed: int = 0,
) -> Iterator[Array]:
    """First guesses of the strokes, shape (count,), the most promising first.

    Args:
        stages: The cycle, beginning with the first stage.
        count: Number of stages.
        places: Where on the path the motion begins and ends.
        coarse: Plans of few segments; None where there are none.
        seed: Seed of the random loops.
    """
    for share in STRATIFIED if coarse else ():
        segments = max(1, int(share * (count - 1) / (2 * len(stages))))
        with suppress(PlannerError):
            flows = coarse(*places, segments) if coarse else ()
            found = amounts_of(stages, flows, count)
            if found is not None:
                yield found
    rng = np.random.default_rng(seed)
    for _ in range(LOOPS):
        yield _loops(count, rng)


def _loops(count: int, rng: np.random.Generator) -> Array:
    """Strokes forward for a while, then backward for as long, and so on."""
    size, half = rng.uniform(0.2, 0.6), int(rng.choice([2, 2, 4, 4, 6]))
    pattern = np.resize(np.repeat([1.0, -1.0], half), count + half)
    turned = np.roll(pattern, int(rng.integers(4 * half)))[:count]
    return turned * size + 0.05 * rng.normal(size=count)
