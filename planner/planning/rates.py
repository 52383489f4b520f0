"""Rates of functions along fields, and whether they vanish where it was tried."""

from collections.abc import Sequence

import numpy as np
import sympy as sp

from planner.errors import PlannerError, message
from planner.numerics.arrays import Array
from planner.systems.fields import Symbols, sample_configurations

NEARBY = 0.3  # of the random configurations at which expressions are compared
VANISHED = 1e-8  # relative, of what must vanish there


def rate_along(function: sp.Expr, field: sp.Matrix, state: Symbols) -> sp.Expr:
    """Rate of a function along a field.

    Parts that occur several times are differentiated once: slopes of slopes are huge
    when written out, and sympy's own derivative goes through them again at every level.
    """
    known: dict[sp.Basic, sp.Expr] = dict(zip(state, field, strict=True))

    def rate(part: sp.Expr) -> sp.Expr:
        if part not in known:
            rates = [rate(inner) for inner in part.args]
            known[part] = _chained(part, rates) if any(rates) else sp.S.Zero
        return known[part]

    return rate(function)


def _chained(part: sp.Expr, rates: Sequence[sp.Expr]) -> sp.Expr:
    """Rate of an expression from the rates of its arguments, by the chain rule."""
    if part.is_Pow and not rates[1]:
        base, power = part.args
        return power * base ** (power - 1) * rates[0]
    stand_ins = [sp.Dummy(real=inner.is_real) for inner in part.args]
    outer = part.func(*stand_ins)
    back = dict(zip(stand_ins, part.args, strict=True))
    moving = [(s, speed) for s, speed in zip(stand_ins, rates, strict=True) if speed]
    return sp.Add(*(outer.diff(s).xreplace(back) * speed for s, speed in moving))


def _values(expression: sp.Expr, state: Symbols) -> Array:
    """Values of an expression near zero, where they are finite."""
    points = NEARBY * sample_configurations(len(state))
    function = sp.lambdify(state, expression, modules=np, cse=True)
    with np.errstate(all="ignore"):
        values = np.array([function(*x) for x in points], dtype=float)
    return values[np.isfinite(values)]


def vanishes(expression: sp.Expr, state: Symbols, size: float = 1.0) -> bool:
    """Whether an expression is zero near zero, relative to a size."""
    return bool(np.abs(_values(expression, state)).max(initial=0.0) <= VANISHED * size)


def declared_or_derived(
    derived: sp.Expr, declared: sp.Expr | None, state: Symbols
) -> sp.Expr:
    """The declared expression if it equals the derived one, or else an error."""
    if declared is None:
        return derived
    size = float(np.abs(_values(derived, state)).max(initial=1.0))
    if not vanishes(derived - declared, state, size):
        raise PlannerError(message("declared", rate=declared))
    return declared
