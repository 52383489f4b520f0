"""What lets fields of higher strata act on the bottom one (Sec. 5.1).

A field that leaves the bottom stratum is made tangent to it with the fields that lift
feet; those lifts must commute with whatever happens while the feet are up (eq. 13), as
Assumption 2 guarantees.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import sympy as sp

from planner.errors import DecouplingError, PlannerError
from planner.numerics.arrays import Array
from planner.numerics.subspaces import rank
from planner.systems.elements import Tree, leaves, relabel
from planner.systems.fields import (
    NumericField,
    VectorField,
    compile_fields,
    lie_bracket,
)
from planner.systems.level_sets import LevelSet
from planner.systems.rounding import vanishing
from planner.systems.strata import StratifiedSystem


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
        if rank(wider) > rates.shape[1]:
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
    if name in names:
        return None
    corrected = _corrected(field, [system.fields[n] for n in names], level_set)
    return None if level_set.leaves(corrected) else corrected


def _corrected(
    field: VectorField, lifting: Sequence[VectorField], level_set: LevelSet
) -> VectorField:
    """A field less what of the lifts moves the level set as it does."""
    if any(isinstance(f, NumericField) for f in (field, *lifting)):
        columns = compile_fields([field, *lifting], level_set.state)

        def value(x: Array) -> Array:
            velocities = columns.values(x)  # (n, 1 + lifts)
            speeds = level_set.gradients(x).T @ velocities
            amounts = np.linalg.lstsq(speeds[:, 1:], speeds[:, 0], rcond=None)[0]
            return velocities[:, 0] - velocities[:, 1:] @ amounts

        return NumericField(value)
    L = sp.Matrix.hstack(*lifting)  # (n, lifts)
    speeds = level_set.differential * L  # (codimension, lifts)
    amounts = (speeds.T * speeds).inv() * speeds.T * level_set.differential * field
    return sp.ImmutableMatrix(sp.simplify(field - L * amounts))


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
    """Lifts and fields that do not commute, by name."""
    pairs = [(lift, name) for lift in raised for name in fields if lift != name]
    brackets = [
        lie_bracket(raised[lift], fields[name], system.state) for lift, name in pairs
    ]
    commute = vanishing(brackets, system.state)
    return [pair for pair, still in zip(pairs, commute, strict=True) if not still]
