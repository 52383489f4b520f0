"""Check what describes a stratified system, and bring it to one form."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import sympy as sp

from planner.errors import point, unknown
from planner.systems.fields import (
    DIFFERENCE,
    NumericField,
    Symbols,
    VectorField,
    central_difference,
    sample_configurations,
)
from planner.systems.formulas import RESERVED, read_formula
from planner.systems.level_sets import LevelSet

HUGE = 1e100  # magnitude of a number; a product of three still fits a float
Written = Any  # a field or formula as a caller writes it: numbers, strings, functions
NAME = re.compile(r"[A-Za-z_]\w*")


def checked_state(state: Iterable[str | sp.Symbol]) -> Symbols:
    """Symbols of a state from symbols, from names, or from one string of names.

    Raises `ValueError` if there are none, or a name is invalid or used twice.
    """
    if isinstance(state, str):
        state = state.replace(",", " ").split()
    symbols = tuple(sp.Symbol(s) if isinstance(s, str) else s for s in state)
    if not symbols:
        raise ValueError("state is empty; name at least one coordinate")
    names = [str(s) for s in symbols]
    for s in symbols:
        if not isinstance(s, sp.Symbol) or not NAME.fullmatch(str(s)):
            raise ValueError(
                f"state has {s!s}, which is not a name; use letters, digits, _"
            )
        if str(s) in RESERVED:
            raise ValueError(f"state has {s}, which formulas use; rename it")
        if names.count(str(s)) > 1:
            raise ValueError(f"state names {s} twice; rename one")
    return symbols


def checked_strata(
    strata: Mapping[str, Mapping[str, Written]], state: Symbols
) -> dict[str, dict[str, VectorField]]:
    """Fields of each stratum as immutable columns, or as numeric fields.

    Raises `ValueError` if a field is misshapen, misnamed or uses other symbols.
    """
    if not strata or not any(strata.values()):
        raise ValueError(
            "strata hold no fields; give at least one stratum with one field"
        )
    checked: dict[str, dict[str, VectorField]] = {}
    owner: dict[str, str] = {}
    for stratum, fields in strata.items():
        checked[stratum] = {}
        for name, value in fields.items():
            if not NAME.fullmatch(name):
                raise ValueError(
                    f"field name {name!r} of S{stratum}: use letters, digits, _"
                )
            if name in owner:
                raise ValueError(
                    f"field {name} is in S{owner[name]} and S{stratum}; rename one"
                )
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
            raise ValueError(
                f"{what} has a derivative of {point(given)} at {point(x)} where "
                f"finite differences give {point(found)}; correct its jacobian or make "
                "it smooth"
            )


def _expression(what: str, value: Written, state: Symbols) -> sp.Expr:
    """A value as an expression; a string is read as a formula."""
    try:
        text = isinstance(value, str)
        expression = (
            read_formula(value, state) if text else sp.sympify(value, strict=True)
        )
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    _require_known(what, expression, state)
    return expression


def _require_known(what: str, expression: sp.Expr, state: Symbols) -> None:
    parts = _parts(expression)
    if {part for part in parts if part.is_Symbol} <= set(state):
        strangers = []
    else:
        strangers = sorted(map(str, expression.free_symbols - set(state)))
    if strangers:
        listed = ", ".join(map(str, state))
        raise ValueError(
            f"{what} uses {strangers[0]}, which is not in the state ({listed})"
        )
    for part in parts:
        if part.is_number and not _is_real(part):
            raise ValueError(f"{what} has {part}, no real number below {HUGE:.0e}")


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
    level_sets: Mapping[str, Written], strata: Iterable[str], state: Symbols
) -> dict[str, tuple[sp.Expr, ...]]:
    """Expressions that vanish on each stratum, given as one or several or as strings.

    Raises `ValueError` if a stratum is unknown, or expressions use other symbols, have
    no derivative or depend on one another.
    """
    checked = {}
    for stratum, functions in level_sets.items():
        if stratum not in strata:
            raise ValueError(
                f"level set of stratum {stratum!r}, which {unknown(stratum, strata)}"
            )
        listed = functions if isinstance(functions, (tuple, list)) else [functions]
        what = f"level set of S{stratum}"
        checked[stratum] = tuple(_expression(what, f, state) for f in listed)
        if kinked := [f for f in checked[stratum] if _kinked(f, state)]:
            raise ValueError(
                f"level set of S{stratum}, {kinked[0]}, has no derivative (Def. 1); "
                "give a smooth function"
            )
        if checked[stratum] and _dependent(checked[stratum], state):
            raise ValueError(
                f"level sets of S{stratum} are not independent: "
                f"{', '.join(map(str, checked[stratum]))} (Def. 1)"
            )
    return checked


def _kinked(function: sp.Expr, state: Symbols) -> bool:
    """Whether SymPy finds no derivative, as of the absolute value."""
    slopes = LevelSet((function,), state).differential
    return bool(slopes.atoms(sp.Derivative) - function.atoms(sp.Derivative))


def _dependent(functions: tuple[sp.Expr, ...], state: Symbols) -> bool:
    return bool(LevelSet(functions, state).differential.rank() < len(functions))
