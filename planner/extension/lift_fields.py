"""Lift fields: those that raise feet off the bottom stratum (Sec. 5.1)."""

from __future__ import annotations

import numpy as np

from planner.numerics.arrays import Array
from planner.numerics.subspaces import rank
from planner.systems.fields import NumericField, VectorField
from planner.systems.strata import StratifiedSystem

EVEN = 0.5  # least over largest rate of a field that is as good a lift as any


def lifts(system: StratifiedSystem, stratum: str, bottom: str = "") -> tuple[str, ...]:
    """Lift fields: those of a stratum that raise feet off the bottom stratum.

    Fields that raise them everywhere alike are preferred, and simple ones among these:
    a field whose rate vanishes somewhere raises nothing there. The lift fields change
    the level sets of the bottom stratum independently of one another.

    Args:
        system: System that has the fields.
        stratum: Stratum on which they act.
        bottom: Stratum that they leave; the bottom stratum of the system if empty.
    """
    level_set = system.level_set(bottom or system.bottom)
    if not level_set.functions:
        return ()
    leaving = [n for n, f in system.strata[stratum].items() if level_set.leaves(f)]
    chosen: list[str] = []
    rates = np.empty((len(level_set.functions), 0))
    found = {name: level_set.rates(system.fields[name]) for name in leaving}
    for name in sorted(
        leaving, key=lambda n: (-_evenness(found[n]), _size(system.fields[n]))
    ):
        rate = found[name][0][:, None]
        wider = np.hstack([rates, rate])
        if rank(wider) > rates.shape[1]:
            chosen, rates = [*chosen, name], wider
    return tuple(chosen)


def _evenness(rates: Array) -> float:
    """Least over largest rate of leaving the level sets; those above `EVEN` are equal.

    Args:
        rates: At configurations on the set, shape (points, codimension).
    """
    sizes = np.linalg.norm(rates, axis=1)
    return min(float(sizes.min() / sizes.max()), EVEN)


def _size(field: VectorField) -> int:
    """Number of coordinates that a field moves."""
    if isinstance(field, NumericField):
        return 10**6
    return sum(entry != 0 for entry in field)
