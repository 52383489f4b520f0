"""Ctrl-C inside a library that swallows it, and searches that answer it.

Whoever handles signals notes the exception that it raises. A search may answer it with
the best that it has found and let the work go on; until then `reraise` raises it again,
for libraries written in C that carry on as if nothing had happened.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Tell = Callable[[], object]


@dataclass(frozen=True)
class _Interruption:
    stop: KeyboardInterrupt
    tell: Tell


_last: list[_Interruption] = []


def note_interruption(stop: KeyboardInterrupt, tell: Tell) -> None:
    """Note an interruption that is about to be raised.

    Args:
        stop: What will be raised.
        tell: Called if a search answers it with its best and lets the work go on.
    """
    _last[:] = [_Interruption(stop, tell)]


def forget_interruption() -> None:
    """Forget the last interruption."""
    _last.clear()


def answer(stop: KeyboardInterrupt) -> None:
    """Say that a search has answered an interruption with its best, and goes on."""
    noted = [last for last in _last if last.stop is stop]
    forget_interruption()
    for last in noted:
        last.tell()


def unanswered_interruption() -> KeyboardInterrupt | None:
    """The interruption that nothing has answered yet, if there is one."""
    return _last[0].stop if _last else None


def reraise() -> None:
    """Raise an interruption again that a library has swallowed."""
    if _last:
        raise _last[0].stop
