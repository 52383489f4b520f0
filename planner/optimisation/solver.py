"""CasADi, which provides exact derivatives and IPOPT; imported when first needed."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from typing import Any, TextIO

import sympy as sp

from planner.errors import PlannerError
from planner.numerics.interruption import reraise, unanswered_interruption

QUIET: dict[str, Any] = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "ipopt.max_iter": 250,
    "ipopt.tol": 1e-6,
    "ipopt.acceptable_iter": 0,
    "ipopt.mu_strategy": "adaptive",
}

WARM: dict[str, Any] = {  # close to where a solution is known to be
    "ipopt.mu_strategy": "monotone",
    "ipopt.mu_init": 1e-6,
    "ipopt.warm_start_init_point": "yes",
    "ipopt.warm_start_bound_push": 1e-8,
    "ipopt.warm_start_bound_frac": 1e-8,
    "ipopt.warm_start_slack_bound_push": 1e-8,
    "ipopt.warm_start_slack_bound_frac": 1e-8,
    "ipopt.warm_start_mult_bound_push": 1e-8,
}


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


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C through, which CasADi swallows with a line of its own."""
    with redirect_stderr(_Filter(sys.stderr)):
        yield
    reraise()


class _Filter(io.TextIOBase):
    """A stream without what CasADi says of Ctrl-C."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return len(text) if unanswered_interruption() else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


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
