"""How a search is stopped: by its limit of time, or by Ctrl-C.

A search calls `tick` regularly, with its best result so far in words. Inside a
`limited` block `tick` raises an error once the time is over, which repeats those words.

Whoever handles signals notes the exception that it raises. A search may answer it with
its best result and let the work go on; until then `tick` raises it again, for libraries
written in C that carry on as if nothing had happened.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from planner.errors import BudgetError


@dataclass(eq=False)
class _Budget:
    seconds: float
    began: float
    report: Callable[[float], None]
    best: str = ""
    next_report: float = 0.0  # [s] after it began


_current: ContextVar[_Budget | None] = ContextVar("budget", default=None)
_open: list[_Budget] = []  # of all threads, the innermost last
_noted: list[tuple[KeyboardInterrupt, Callable[[], object]]] = []
"""The last interruption until it is answered, and what is called then."""


@contextmanager
def limited(
    seconds: float, report: Callable[[float], None] = lambda share: None
) -> Iterator[None]:
    """Limit the time [s] of the searches inside a `with` block together.

    `report` is called with the share of the time that has passed. The `BudgetError` of
    searches that take longer describes the best result so far.
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


@contextmanager
def unlimited() -> Iterator[None]:
    """Let what is inside end, even if the time to search in is over."""
    token = _current.set(None)
    try:
        yield
    finally:
        _current.reset(token)


def tick(best: str = "") -> None:
    """Report that a search is still running, and its best result so far in words.

    Raises `BudgetError` if the time is over, and an interruption that was noted and
    that nothing has answered.
    """
    if stop := unanswered_interruption():
        raise stop
    budget = _current.get()
    if budget is None:
        return
    budget.best = best or budget.best
    spent = time.monotonic() - budget.began
    if spent > budget.seconds:
        raise BudgetError(budget.seconds, budget.best)
    if spent >= budget.next_report:
        budget.next_report = spent + 0.1  # [s] at least
        budget.report(spent / budget.seconds)


def best_so_far() -> str:
    """The best that the searches going on have found, in words; empty if nothing."""
    return next((budget.best for budget in reversed(_open) if budget.best), "")


def note_interruption(
    stop: KeyboardInterrupt, when_answered: Callable[[], object]
) -> None:
    """Note an interruption; `when_answered` is called if a search answers it."""
    _noted[:] = [(stop, when_answered)]


def forget_interruption() -> None:
    """Forget the last interruption."""
    _noted.clear()


def unanswered_interruption() -> KeyboardInterrupt | None:
    """The interruption that nothing has answered yet, if there is one."""
    return _noted[0][0] if _noted else None


def answer(stop: KeyboardInterrupt) -> None:
    """Take a search's best result as the answer to an interruption; work goes on."""
    noted = [when_answered for last, when_answered in _noted if last is stop]
    forget_interruption()
    for when_answered in noted:
        when_answered()
