"""CasADi's expressions, with exact derivatives, and its solver IPOPT.

CasADi is imported when it is first needed. It takes Ctrl-C for a failure of the problem
and forgets it. While IPOPT runs, signals are therefore only noted; its next iteration
ends the run, and they are raised again after it. A run also ends when the time to plan
in is over.
"""

import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from types import FrameType
from typing import Any

import sympy as sp

from planner.errors import PlannerError, installing, message, shipped_tables
from planner.numerics.arrays import Array
from planner.support.stopping import tick

Expression = Any  # of CasADi, or the module itself, which have no types

QUIET, WARM = shipped_tables("planner.optimisation", "ipopt.toml").values()
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU)
SAME_NAME = (
    "sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "atan2", "sign",
    "asin", "acos", "atan", "pi",
)  # fmt: skip


class MissingSolverError(PlannerError):
    """Optimising was asked for, and its solver is not installed."""

    def __init__(self) -> None:
        super().__init__(message("no_solver", install=installing("optimise")))


def solver() -> Expression:
    """The module `casadi`; raises `MissingSolverError` where it is not installed."""
    try:
        import casadi
    except ImportError as error:
        raise MissingSolverError from error
    return casadi


@lru_cache  # programs of all sizes have the same few fields
def casadi_function(
    state: tuple[sp.Symbol, ...], expressions: tuple[sp.Expr, ...]
) -> Callable[[Expression], list[Expression]]:
    """SymPy expressions over a state as a function of CasADi's symbols of it."""
    ca = solver()
    named = {name: getattr(ca, name) for name in SAME_NAME} | {"Abs": ca.fabs}
    sign = sp.Function("sign")  # sympy's own would be written with branches
    plain = [expression.replace(sp.sign, sign) for expression in expressions]
    function = sp.lambdify(state, plain, modules=[named], cse=True, dummify=True)
    return lambda x: list(function(*(x[i] for i in range(len(state)))))


class Ipopt:
    """A nonlinear program in CasADi's `x`, `f` and `g` that is solved repeatedly."""

    def __init__(
        self, program: Mapping[str, Expression], options: dict[str, Any] | None = None
    ) -> None:
        self._given = program, options or {}
        self._watch = _watch()(program["x"].numel(), program["g"].numel())
        settings = QUIET | {"iteration_callback": self._watch} | self._given[1]
        self._solver = solver().nlpsol("plan", "ipopt", program, settings)

    def warm(self) -> "Ipopt":
        """The same program, with its derivatives, to be solved from near a solution."""
        program, options = self._given
        names = {"grad_f": "nlp_grad_f", "jac_g": "nlp_jac_g", "hess_lag": "nlp_hess_l"}
        derived = {key: self._solver.get_function(n) for key, n in names.items()}
        return Ipopt(program, options | WARM | derived)

    def __call__(self, **values: Array) -> dict[str, Expression] | None:
        """The local optimum from a guess `x0` in bounds `lbx`, `ubx`, `lbg`, `ubg`.

        None if none was found; `BudgetError` if the time to plan in is over.
        """
        with _noted() as noted:
            found = self._solver(**values) if self._watch.began(noted) else {}
        if self._watch.stopped is not None:
            raise self._watch.stopped
        return dict(found) if bool(found) and self._solver.stats()["success"] else None


@contextmanager
def _noted() -> Iterator[list[int]]:
    """Note signals during the block; the first is handled at its end."""
    noted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield noted
        return

    def note(number: int, frame: FrameType | None) -> None:
        noted.append(number)

    heeded = [number for number in SIGNALS if callable(signal.getsignal(number))]
    before = {number: signal.signal(number, note) for number in heeded}
    try:
        yield noted
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for arrived in noted[:1]:
            if callable(handler := before[signal.Signals(arrived)]):
                handler(arrived, None)


@lru_cache(maxsize=1)
def _watch() -> Callable[[int, int], Expression]:
    """The class of the callback that IPOPT calls at every iteration."""
    ca = solver()
    given = [ca.nlpsol_out(i) for i in range(ca.nlpsol_n_out())]

    class Watch(ca.Callback):  # type: ignore[misc, name-defined]
        def __init__(self, unknowns: int, rows: int) -> None:
            super().__init__()
            self._sizes = {"f": 1, "x": unknowns, "lam_x": unknowns}
            self._sizes |= {"g": rows, "lam_g": rows}
            self._noted: list[int] = []
            self.stopped: BaseException | None = None
            self.construct("watch", {})

        def began(self, noted: list[int]) -> bool:
            self._noted, self.stopped = noted, None
            return not noted

        def get_n_in(self) -> int:
            return len(given)

        def get_sparsity_in(self, i: int) -> Expression:
            return ca.Sparsity.dense(self._sizes.get(given[i], 0), 1)

        def eval(self, arguments: Expression) -> list[int]:
            try:
                tick()
            except (Exception, KeyboardInterrupt) as error:
                self.stopped = error
            return [int(self.stopped is not None or bool(self._noted))]

    return Watch
