"""How long a search may take, and what it has found so far.

Searches call `tick` as they go on, which does nothing outside of `limited`. Inside, it
ends a search that takes too long, and what it was told last is said whenever the search
ends early.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from planner.errors import BudgetError
from planner.numerics.interruption import reraise


@dataclass(eq=False)
class _Budget:
    seconds: float
    began: float
    report: Callable[[float], None]
    best: str = ""


_current: ContextVar[_Budget | None] = ContextVar("budget", default=None)
_open: list[_Budget] = []  # of all threads, the innermost last


@contextmanager
def limited(
    seconds: float, report: Callable[[float], None] = lambda share: None
) -> Iterator[None]:
    """Give the searches inside a time to end in.

    Args:
        seconds: How long they may take together [s].
        report: Called with the share of the time that is over.

    Raises:
        BudgetError: If they take longer; it says how far they came.
    """
    budget = _Budget(seconds, time.monotonic(), report)
    token = _current.set(budget)
    _open.append(budget)
    try:
        yield
    except BaseException as stop:
        if budget.best:
            stop.add_note(f"planning had come to {budget.best}")
        raise
    finally:
        _open.remove(budget)
        _current.reset(token)


def best_so_far() -> str:
    """The best that the searches going on have found, in words; empty if nothing."""
    return next((budget.best for budget in reversed(_open) if budget.best), "")


def tick(best: str = "") -> None:
    """Say that a search goes on.

    Args:
        best: The best that it has found, in words; empty if nothing new.

    Raises:
        BudgetError: If its time is over.
    """
    reraise()
    budget = _current.get()
    if budget is None:
        return
    budget.best = best or budget.best
    spent = time.monotonic() - budget.began
    if spent > budget.seconds:
        raise BudgetError(budget.seconds, budget.best)
    budget.report(spent / budget.seconds)
