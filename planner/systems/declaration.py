"""Check what describes a stratified system, and bring it to one form."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from math import inf
from typing import Any

import numpy as np
import sympy as sp

from planner.errors import message, point, require_known
from planner.systems.fields import (
    DIFFERENCE,
    NumericField,
    Symbols,
    VectorField,
    central_difference,
    sample_configurations,
)
from planner.systems.formulas import HUGE, RESERVED, read_formula
from planner.systems.level_sets import LevelSet

Written = Any  # a field or formula as a caller writes it: numbers, strings, functions
NAME = re.compile(r"[A-Za-z_]\w*")


def checked_state(state: Iterable[str | sp.Symbol]) -> Symbols:
    """Symbols of a state from symbols, from names, or from one string of names."""
    if isinstance(state, str):
        state = state.replace(",", " ").split()
    symbols = tuple(sp.Symbol(s) if isinstance(s, str) else s for s in state)
    if not symbols:
        raise ValueError("state is empty; name at least one coordinate")
    names = [str(s) for s in symbols]
    for s, name in zip(symbols, names, strict=True):
        if not isinstance(s, sp.Symbol) or not NAME.fullmatch(name):
            raise ValueError(message("no_name", name=name))
        if name in RESERVED:
            raise ValueError(f"state has {name}, which formulas use; rename it")
        if names.count(name) > 1:
            raise ValueError(f"state names {name} twice; rename one")
    return symbols


def checked_strata(
    strata: Mapping[str, Mapping[str, Written]], state: Symbols
) -> dict[str, dict[str, VectorField]]:
    """Fields of each stratum as immutable columns, or as numeric fields."""
    if not strata or not any(strata.values()):
        raise ValueError(message("no_fields"))
    checked: dict[str, dict[str, VectorField]] = {}
    owner: dict[str, str] = {}
    for stratum, fields in strata.items():
        checked[stratum] = {}
        for name, value in fields.items():
            if not NAME.fullmatch(name):
                raise ValueError(message("field_name", name=name, stratum=stratum))
            if name in owner:
                both = owner[name], stratum
                raise ValueError(message("in_two", name=name, strata=both))
            owner[name] = stratum
            checked[stratum][name] = _field(f"field {name} of S{stratum}", value, state)
    return checked


def _field(what: str, value: Written, state: Symbols) -> VectorField:
    if callable(value) and not isinstance(value, sp.Basic):
        field = value if isinstance(value, NumericField) else NumericField(value)
        _require_differentiable(what, field, len(state))
        return field
    entries = np.atleast_1d(np.asarray(value, dtype=object))
    read_all = np.vectorize(lambda e: _expression(what, e, state), otypes=[object])
    column = sp.ImmutableMatrix(read_all(entries))
    if column.shape != (len(state), 1):
        raise ValueError(f"{what} has shape {column.shape}, expected ({len(state)}, 1)")
    return column


def _require_differentiable(what: str, field: NumericField, size: int) -> None:
    """Compare derivatives, given or by differences, with finer differences."""
    for x in sample_configurations(size):
        direction = np.cos(np.arange(size) + x)  # any direction serves
        given = field.derivative(x, direction)
        found = central_difference(field, x, direction, DIFFERENCE / 4)
        if np.isfinite(found).all() and not np.allclose(given, found, 1e-6, 1e-6):
            facts = {"given": point(given), "place": point(x), "found": point(found)}
            raise ValueError(message("derivative", what=what, **facts))


def _expression(what: str, value: Written, state: Symbols) -> sp.Expr:
    """A value as an expression of the state; a string is read as a formula."""
    try:
        text = isinstance(value, str)
        expression = (
            read_formula(value, state) if text else sp.sympify(value, strict=True)
        )
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    parts = _parts(expression)
    known = {part for part in parts if part.is_Symbol} <= set(state)
    if not known and (strangers := expression.free_symbols - set(state)):
        stranger, names = min(map(str, strangers)), ", ".join(map(str, state))
        raise ValueError(message("strange", what=what, stranger=stranger, state=names))
    for part in parts:
        odd = part.is_Pow and not part.exp.is_integer and part.base.is_negative
        if odd or (part.is_number and not _is_real(part)):
            raise ValueError(f"{what} has {part!s}, no real number below {HUGE:.0e}")
    return expression


def _parts(expression: sp.Expr) -> dict[sp.Basic, None]:
    """The parts of an expression, each once; brackets repeat theirs many times."""
    parts: dict[sp.Basic, None] = {}
    waiting: list[sp.Basic] = [expression]
    while waiting:
        part = waiting.pop()
        if part not in parts:
            parts[part] = None
            waiting += part.args
    return parts


def _is_real(number: sp.Expr) -> bool:
    try:
        return abs(float(number)) < HUGE
    except (TypeError, OverflowError):
        return False


def checked_level_sets(
    level_sets: Mapping[str, Written], strata: Collection[str], state: Symbols
) -> dict[str, tuple[sp.Expr, ...]]:
    """Expressions that vanish on each stratum, given as one or several or as strings.

    They are independent, and SymPy has no kink in them, as of the absolute value.
    """
    checked: dict[str, tuple[sp.Expr, ...]] = {}
    for stratum, given in level_sets.items():
        require_known(f"level set of stratum {stratum!r}, which", stratum, strata)
        listed = given if isinstance(given, (tuple, list)) else [given]
        what = f"level set of S{stratum}"
        functions = tuple(_expression(what, f, state) for f in listed)
        checked[stratum] = functions
        for f in functions:
            slopes = LevelSet((f,), state).differential
            if slopes.atoms(sp.Derivative) - f.atoms(sp.Derivative):
                raise ValueError(message("not_smooth", what=what, function=f))
        level_set, count = LevelSet(functions, state), len(functions)
        if functions and level_set.differential.rank() < count:
            what = f"level sets of S{stratum} are not independent"
            raise ValueError(f"{what}: {', '.join(map(str, functions))} (Def. 1)")
    return checked


def checked_metric(
    metric: Mapping[str | sp.Symbol, float], state: Symbols
) -> dict[str, float]:
    """Lengths that units of coordinates count as, by name, but for those of 1."""
    names = [str(symbol) for symbol in state]
    for name, weight in metric.items():
        require_known(f"metric has {name}, which", str(name), names)
        if not 0.0 < weight < inf:
            raise ValueError(message("weight", name=name, weight=weight))
    return {str(name): float(w) for name, w in metric.items() if w != 1}


def checked_lifts(
    lifts: Mapping[str, Sequence[str] | str],
    strata: Mapping[str, Mapping[str, VectorField]],
) -> dict[str, tuple[str, ...]]:
    """Names of the lift fields of strata, each a field of its stratum."""
    checked = {}
    for stratum, given in lifts.items():
        require_known(f"lifts of stratum {stratum!r}, which", stratum, strata)
        checked[stratum] = (given,) if isinstance(given, str) else tuple(given)
        for name in checked[stratum]:
            require_known(f"lift {name!r} of S{stratum}", name, strata[stratum])
    return checked
