"""CasADi, which provides exact derivatives and IPOPT; imported when first needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from planner.errors import PlannerError


class MissingSolverError(PlannerError):
    """Optimising was asked for, and its solver is not installed."""

    def __init__(self) -> None:
        super().__init__(
            "optimising needs CasADi with IPOPT, which is not installed; "
            "pip install 'stratawalk[optimise]', or leave optimise at none"
        )


def solver() -> Any:
    """The module `casadi`.

    Raises:
        MissingSolverError: It is not installed.
    """
    try:
        import casadi
    except ImportError as error:
        raise MissingSolverError from error
    return casadi


def casadi_function(
    state: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]
) -> Callable[[Any], list[Any]]:
    """Expressions over a state as a function of its CasADi symbols.

    Args:
        state: Symbols of the state.
        expressions: What to evaluate.
    """
    ca = solver()
    named = {name: getattr(ca, name) for name in ("sin", "cos", "tan", "exp", "log")}
    named |= {name: getattr(ca, name) for name in ("sqrt", "sinh", "cosh", "tanh")}
    named |= {"Abs": ca.fabs, "sign": ca.sign, "atan2": ca.atan2, "pi": ca.pi}
    named |= {"asin": ca.asin, "acos": ca.acos, "atan": ca.atan}
    function = sp.lambdify(
        state, list(expressions), modules=[named], cse=True, dummify=True
    )
    return lambda x: list(function(*(x[i] for i in range(len(state)))))
