"""A time limit for searches, which also reports the best result found so far.

A search calls `tick` regularly. Inside a `limited` block, `tick` raises an error once
the time is over; outside of such a block it does nothing. The search may describe its
best result to `tick`; the description becomes part of the message if it ends early.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from planner.errors import BudgetError
from planner.numerics.interruption import reraise

SELDOM = 0.1  # [s] between two reports at least


@dataclass(eq=False)
class _Budget:
    seconds: float
    began: float
    report: Callable[[float], None]
    best: str = ""
    next_report: float = 0.0  # [s] after it began


_current: ContextVar[_Budget | None] = ContextVar("budget", default=None)
_open: list[_Budget] = []  # of all threads, the innermost last


@contextmanager
def limited(
    seconds: float, report: Callable[[float], None] = lambda share: None
) -> Iterator[None]:
    """Limit the time of the searches inside a `with` block.

    Args:
        seconds: Time that they may take together [s].
        report: Function that is called with the share of the time that has passed.

    Raises:
        BudgetError: If they take longer; it describes the best result so far.
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


@contextmanager
def unlimited() -> Iterator[None]:
    """Let what is inside end, even if the time to search in is over."""
    token = _current.set(None)
    try:
        yield
    finally:
        _current.reset(token)


def tick(best: str = "") -> None:
    """Report that a search is still running.

    Args:
        best: Its best result so far in words; empty if there is no better one.

    Raises:
        BudgetError: If the time is over.
    """
    reraise()
    budget = _current.get()
    if budget is None:
        return
    budget.best = best or budget.best
    spent = time.monotonic() - budget.began
    if spent > budget.seconds:
        raise BudgetError(budget.seconds, budget.best)
    if spent >= budget.next_report:
        budget.next_report = spent + SELDOM
        budget.report(spent / budget.seconds)
