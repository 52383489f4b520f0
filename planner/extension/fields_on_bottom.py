"""Fields of higher strata, made to act on the bottom stratum, eqs. (13) and (14).

Flows of eq. (12) that lift a foot, move and set it down are interchanged until lifting
and setting down cancel. Lift fields must therefore commute with the fields used while
feet are in the air, eq. (13), as Assumption 2 guarantees. A field that leaves the
bottom stratum is corrected by the lift fields (Sec. 5.1).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np
import sympy as sp

from planner.errors import DecouplingError, PlannerError, StratumError, message
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
    """Lift fields of a stratum: fields that raise feet off the bottom stratum.

    They change the level sets of the bottom stratum, or of another one that is named,
    independently of one another. They are those that the system declares for the
    stratum; or all fields that leave, if these are independent; or the fields that move
    nothing but heights, as in Assumption 2. `StratumError` if that leaves a choice.
    """
    level_set = system.level_set(bottom or system.bottom)
    if not level_set.functions:
        return ()
    fields = system.strata[stratum]
    rates = {name: level_set.rates(f) for name, f in fields.items()}
    leaving = [name for name, found in rates.items() if found.any()]

    def independent(names: Sequence[str]) -> int:
        first = [rates[name][0][:, None] for name in names]
        return rank(np.hstack(first)) if first else 0

    needed = independent(leaving)
    declared = [name for name in system.lifts.get(stratum, ()) if name in leaving]
    upright = [n for n in leaving if _moves_heights_alone(fields[n], level_set)]
    for names in (declared, leaving, upright):
        if len(names) == needed == independent(names):
            return tuple(names)
    facts = {"stratum": stratum, "leaving": ", ".join(leaving), "needed": needed}
    facts |= {"lift": "lifts" if needed == 1 else "lift"}
    raise StratumError(message("which_lifts", example={stratum: leaving[:1]}, **facts))


def _moves_heights_alone(field: VectorField, level_set: LevelSet) -> bool:
    """Whether all that a field moves are coordinates that level sets rise with."""
    if isinstance(field, NumericField):
        moved = np.flatnonzero(np.any([field(x) for x in level_set.points], axis=0))
    else:
        moved = np.flatnonzero([rate != 0 for rate in field])
    steady = [level_set.differential.col(i) for i in moved.tolist()]
    return all(c.is_zero_matrix is False and not c.free_symbols for c in steady)


def require_decoupled(system: StratifiedSystem, names: Iterable[str]) -> None:
    """Check eq. (13): lift fields commute with the fields used on the same stratum.

    Raises:
        DecouplingError: A lift field does not commute with a field; both are named.

    Example:
        >>> from planner import DecouplingError, StratifiedSystem, require_decoupled
        >>> fields = {"1": {}, "0": {"lift": [0, 1], "swing": ["h", 0]}}
        >>> foot = StratifiedSystem("x h", fields, "1", level_sets={"1": "h"})
        >>> try:
        ...     require_decoupled(foot, ["swing"])
        ... except DecouplingError as error:
        ...     error.lift, error.field
        ('lift', 'swing')
    """
    fields = {name: system.fields[name] for name in names}
    for stratum in system.strata:
        here = {n: f for n, f in fields.items() if system.stratum_of[n] == stratum}
        raised = {n: system.fields[n] for n in lifts(system, stratum) if here}
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


def tangent_field(
    system: StratifiedSystem, name: str, bottom: str = ""
) -> VectorField | None:
    """A field made tangent to the bottom stratum, g_12 - (f_1 / f_2) g_11 in Sec. 5.1.

    That is the field itself if it is tangent, and None if it is a lift field, or if the
    lift fields cannot make it tangent. `bottom` is a stratum, that of the system if
    empty.

    Raises:
        StratumError: It is unclear which fields lift on its stratum; give them in the
            system's `lifts`.

    Example:
        >>> from planner import StratifiedSystem, tangent_field
        >>> fields = {"1": {}, "0": {"lift": [0, 1], "swing": [1, 1]}}
        >>> foot = StratifiedSystem("x h", fields, "1", level_sets={"1": "h"})
        >>> list(tangent_field(foot, "swing"))
        [1, 0]
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
    """A field minus the combination of lift fields that changes the level set alike."""
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
    """Make elements act on the bottom stratum as in eq. (14).

    The system has a field `NAME_tangent` for every field NAME that is corrected, and
    the elements, names of fields or a `Bracket` of elements, are over these.

    Raises:
        DecouplingError: A lift field does not commute with a field that is used while
            the foot is in the air, eq. (13).
        PlannerError: A field leaves the bottom stratum, and no lift field can make it
            tangent.

    Example:
        >>> from planner import StratifiedSystem, on_bottom
        >>> fields = {"1": {}, "0": {"lift": [0, 1], "swing": [1, 1]}}
        >>> foot = StratifiedSystem("x h", fields, "1", level_sets={"1": "h"})
        >>> system, elements = on_bottom(foot, ["swing"])
        >>> elements
        ['swing_tangent']
    """
    used = dict.fromkeys(chain(*map(leaves, trees)))
    renamed: dict[str, str] = {}
    strata = {stratum: dict(fields) for stratum, fields in system.strata.items()}
    for name in used:
        field = tangent_field(system, name)
        if field is None:
            facts = {"bottom": system.bottom, "stratum": system.stratum_of[name]}
            raise PlannerError(message("not_held", name=name, **facts))
        if field is not system.fields[name]:
            renamed[name] = f"{name}_tangent"
            strata[system.stratum_of[name]][renamed[name]] = field
    if renamed:
        system = replace(system, strata=strata)
        trees = [relabel(tree, lambda name: renamed.get(name, name)) for tree in trees]
    require_decoupled(system, (renamed.get(name, name) for name in used))
    return system, list(trees)
