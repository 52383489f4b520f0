"""Decoupling, eq. (13): lift fields commute with fields used while feet are in the air.

Assumption 2 guarantees that they do. Then flows may be interchanged as in eq. (14), so
that fields of higher strata act on the bottom one; `fields_on_bottom` has these fields.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from planner.errors import DecouplingError
from planner.extension.lift_fields import lifts
from planner.systems.fields import VectorField, lie_bracket
from planner.systems.rounding import vanishing
from planner.systems.strata import StratifiedSystem


def require_decoupled(system: StratifiedSystem, names: Iterable[str]) -> None:
    """Check eq. (13): lift fields commute with the fields used on the same stratum.

    Args:
        system: System that has the fields.
        names: Fields that are used on strata above the bottom stratum.

    Raises:
        DecouplingError: A lift field does not commute with a field; both are named.
    """
    fields = {name: system.fields[name] for name in names}
    for stratum in system.strata:
        raised = {n: system.fields[n] for n in lifts(system, stratum)}
        here = {n: f for n, f in fields.items() if system.stratum_of[n] == stratum}
        for lift, name in coupled(system, raised, here):
            raise DecouplingError(lift, name)


def coupled(
    system: StratifiedSystem,
    raised: Mapping[str, VectorField],
    fields: Mapping[str, VectorField],
) -> list[tuple[str, str]]:
    """Pairs of a lift field and a field that do not commute, by name."""
    pairs = [(lift, name) for lift in raised for name in fields if lift != name]
    brackets = [
        lie_bracket(raised[lift], fields[name], system.state) for lift, name in pairs
    ]
    commute = vanishing(brackets, system.state)
    return [pair for pair, still in zip(pairs, commute, strict=True) if not still]
