"""Exact ranks by rational arithmetic, where rounding errors could decide a verdict."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from planner.numerics.arrays import Array
from planner.systems.fields import NumericField, Symbols, VectorField

MOST_ENTRIES = 400  # of the matrix whose rank is found; more take too long


def exact_rank(fields: Iterable[VectorField], state: Symbols, at: Array) -> int | None:
    """Rank of fields at a configuration, every number taken as it is written.

    Args:
        fields: Fields as symbolic columns.
        state: Symbols of the state.
        at: Configuration, shape (n,).

    Returns:
        None where it cannot be told exactly, because a field is a function, or has a
        value at the configuration that is no fraction.
    """
    columns = list(fields)
    if any(isinstance(field, NumericField) for field in columns):
        return None
    if len(columns) * len(state) > MOST_ENTRIES:
        return None
    place = {s: _decimal(value) for s, value in zip(state, at.tolist(), strict=True)}
    values = [[_exact(entry).subs(place) for entry in field] for field in columns]
    if not all(entry.is_Rational for column in values for entry in column):
        return None
    return int(sp.Matrix(values).rank()) if values else 0


def _exact(entry: sp.Expr) -> sp.Expr:
    floats = {number: _decimal(float(number)) for number in entry.atoms(sp.Float)}
    return entry.xreplace(floats)


def _decimal(number: float) -> sp.Rational:
    """The decimal that a float was written as: 0.1 + 0.2 is 0.3 then."""
    return sp.Rational(f"{number:.15g}")
