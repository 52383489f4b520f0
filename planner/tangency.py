"""What lets fields of higher strata act on the bottom one (Sec. 5.1).

A field that leaves the bottom stratum is made tangent to it with the fields that lift
feet; those lifts must commute with whatever happens while the feet are up (eq. 13), as
Assumption 2 guarantees.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import sympy as sp

from planner.elements import Tree, leaves, relabel
from planner.errors import DecouplingError, PlannerError
from planner.fields import NumericField, VectorField, lie_bracket, vanishing
from planner.strata import StratifiedSystem


def lifts(system: StratifiedSystem, stratum: str, bottom: str = "") -> tuple[str, ...]:
    """Fields of a stratum that take feet off the bottom stratum, the simplest first.

    As many as move its level sets independently of one another.
    """
    level_set = system.level_set(bottom or system.bottom)
    if not level_set.functions:
        return ()
    leaving = [n for n, f in system.strata[stratum].items() if level_set.leaves(f)]
    chosen: list[str] = []
    rates = np.empty((len(level_set.functions), 0))
    for name in sorted(leaving, key=lambda n: _size(system.fields[n])):
        rate = level_set.rates(system.fields[name])[0][:, None]
        wider = np.hstack([rates, rate])
        if np.linalg.matrix_rank(wider) > rates.shape[1]:
            chosen, rates = [*chosen, name], wider
    return tuple(chosen)


def _size(field: VectorField) -> int:
    """Number of coordinates that a field moves."""
    if isinstance(field, NumericField):
        return 10**6
    return sum(entry != 0 for entry in field)


def tangent_field(
    system: StratifiedSystem, name: str, bottom: str = ""
) -> VectorField | None:
    """A field made tangent to the bottom stratum, g - (f1/f2) lift in Sec. 5.1.

    Returns:
        The field itself where it is tangent, None where no lift can hold it there or it
        is itself the lift.
    """
    field = system.fields[name]
    level_set = system.level_set(bottom or system.bottom)
    if not level_set.functions or not level_set.leaves(field):
        return field
    names = lifts(system, system.stratum_of[name], bottom)
    lift_fields = [system.fields[n] for n in names if n != name]
    if name in names or any(isinstance(f, NumericField) for f in (field, *lift_fields)):
        return None
    L = sp.Matrix.hstack(*lift_fields)  # (n, lifts)
    speeds = level_set.differential * L  # (codimension, lifts)
    amounts = (speeds.T * speeds).inv() * speeds.T * level_set.differential * field
    corrected = sp.ImmutableMatrix(sp.simplify(field - L * amounts))
    return None if level_set.leaves(corrected) else corrected


def on_bottom(
    system: StratifiedSystem, trees: Sequence[Tree]
) -> tuple[StratifiedSystem, list[Tree]]:
    """Make elements act on the bottom stratum, or say why they cannot.

    Args:
        system: System whose fields the elements are made of.
        trees: Elements over field names.

    Returns:
        The system, with a field `NAME_tangent` for every NAME that had to be corrected,
        and the elements over these.

    Raises:
        DecouplingError: A lift does not commute with a field used while a foot is up.
        PlannerError: A field leaves the bottom stratum and nothing can hold it there.
    """
    used = dict.fromkeys(leaf for tree in trees for leaf in leaves(tree))
    renamed: dict[str, str] = {}
    strata = {stratum: dict(fields) for stratum, fields in system.strata.items()}
    for name in used:
        field = tangent_field(system, name)
        if field is None:
            raise PlannerError(
                f"field {name} leaves S{system.bottom} and no lift of "
                f"S{system.stratum_of[name]} can hold it there (Sec. 5.1); leave it out"
            )
        if field is not system.fields[name]:
            renamed[name] = f"{name}_tangent"
            strata[system.stratum_of[name]][renamed[name]] = field
    if renamed:
        system = replace(system, strata=strata)
        trees = [relabel(tree, lambda name: renamed.get(name, name)) for tree in trees]
    require_decoupled(system, (renamed.get(name, name) for name in used))
    return system, list(trees)


def require_decoupled(system: StratifiedSystem, names: Iterable[str]) -> None:
    """Check eq. (13): lifting feet commutes with the fields used while they are up.

    Args:
        system: System that has the fields.
        names: Fields used on strata above the bottom one.

    Raises:
        DecouplingError: A lift does not commute with a field; both are named.
    """
    pairs = [
        (lift, name)
        for name in names
        for lift in lifts(system, system.stratum_of[name])
        if lift != name
    ]
    brackets = [
        lie_bracket(system.fields[lift], system.fields[name], system.state)
        for lift, name in pairs
    ]
    for (lift, name), commuting in zip(
        pairs, vanishing(brackets, system.state), strict=True
    ):
        if not commuting:
            raise DecouplingError(lift, name)
