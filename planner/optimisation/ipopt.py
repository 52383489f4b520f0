"""IPOPT, watched: it ends when its time is over, and at once on Ctrl-C.

CasADi takes Ctrl-C for a failure of the problem and forgets it. Signals are therefore
only noted while IPOPT runs, which is told so at its next iteration, and are raised
again when it has returned.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from types import FrameType
from typing import Any

from planner.numerics.arrays import Array
from planner.optimisation.solver import solver
from planner.support.stopping import tick

QUIET: dict[str, Any] = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "ipopt.max_iter": 250,
    "ipopt.tol": 1e-6,
    "ipopt.acceptable_iter": 0,
}

WARM: dict[str, Any] = {  # close to where a solution is known to be
    "ipopt.mu_init": 1e-6,
    "ipopt.warm_start_init_point": "yes",
    "ipopt.warm_start_bound_push": 1e-8,
    "ipopt.warm_start_bound_frac": 1e-8,
    "ipopt.warm_start_slack_bound_push": 1e-8,
    "ipopt.warm_start_slack_bound_frac": 1e-8,
    "ipopt.warm_start_mult_bound_push": 1e-8,
}

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Ipopt:
    """A nonlinear program, to be solved again and again.

    Args:
        program: Unknowns `x`, cost `f` and rows `g` as CasADi's expressions.
        options: Of CasADi and IPOPT, beside those that keep them quiet.
    """

    def __init__(
        self, program: dict[str, Any], options: dict[str, Any] | None = None
    ) -> None:
        sizes = program["x"].numel(), program["g"].numel()
        self._watch = _watch()(*sizes)
        watched = {"iteration_callback": self._watch}
        self._solver = solver().nlpsol(
            "plan", "ipopt", program, QUIET | watched | (options or {})
        )

    def __call__(self, **values: Array) -> dict[str, Any] | None:
        """The local optimum; None if none was found.

        Args:
            values: Guess `x0`, and bounds `lbx`, `ubx`, `lbg`, `ubg`.

        Raises:
            BudgetError: If the time to plan in is over.
        """
        with _noted() as noted:
            found = self._solver(**values) if self._watch.began(noted) else {}
        if self._watch.stopped is not None:
            raise self._watch.stopped
        good = bool(found) and self._solver.stats()["success"]
        return dict(found) if good else None


@contextmanager
def _noted() -> Iterator[list[int]]:
    """Signals that arrive meanwhile, raised again at the end."""
    noted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield noted
        return

    def note(number: int, frame: FrameType | None) -> None:
        noted.append(number)

    before = {number: signal.signal(number, note) for number in SIGNALS}
    try:
        yield noted
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for arrived in noted[:1]:
            signal.raise_signal(arrived)


@lru_cache(maxsize=1)
def _watch() -> Callable[[int, int], Any]:
    """The class of CasADi's callbacks that IPOPT calls at every iteration."""
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

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, i: int) -> Any:
            return ca.Sparsity.dense(self._sizes.get(given[i], 0), 1)

        def eval(self, arguments: Any) -> list[int]:
            try:
                tick()
            except (Exception, KeyboardInterrupt) as error:
                self.stopped = error
            return [int(self.stopped is not None or bool(self._noted))]

    return Watch
