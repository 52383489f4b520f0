"""Ctrl-C and SIGTERM: how the command answers them, whatever it is doing.

The first signal raises an exception where the command is, so that it can save what it
has; the second ends it at once. A library may turn that exception into an error of its
own, which `meant` undoes. Where a library is busy for long without returning to Python,
a thread that waits beside ends the command.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from planner import best_so_far, remove_unfinished, was_answered

ENDS = {
    signal.SIGINT: (130, "interrupted: Ctrl-C"),
    signal.SIGTERM: (143, "terminated: SIGTERM"),
}
PATIENCE = 0.6  # [s] in which the command has to notice a signal


class Terminated(KeyboardInterrupt):
    """SIGTERM, raised where it arrives as Ctrl-C raises KeyboardInterrupt."""


class _Last:
    """The last signal: what it raised, and when the command noticed it."""

    stop: KeyboardInterrupt | None = None
    noticed = -PATIENCE


def listen() -> None:
    """Answer signals from now on; whoever sends SIGINT to a background job means it."""
    _Last.stop = None
    for number in ENDS:
        signal.signal(number, _raise)


def watch() -> None:
    """Start the thread that ends the command where it does not notice a signal."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=_wait, args=(reader,), daemon=True).start()


def meant(error: BaseException) -> BaseException:
    """The interruption that an error stands for, or the error itself.

    Libraries written in C answer an exception raised inside them with one of their own,
    for example that an import failed.
    """
    stop = _unanswered()
    if stop is None or isinstance(error, KeyboardInterrupt):
        return error
    for note in getattr(error, "__notes__", ()):
        stop.add_note(note)
    return stop


def _raise(number: int, frame: FrameType | None) -> NoReturn:
    _Last.noticed = time.monotonic()
    if _unanswered() is not None:
        _end_now(number, "for the second time")
    _Last.stop = Terminated() if number == signal.SIGTERM else KeyboardInterrupt()
    raise _Last.stop


def _unanswered() -> KeyboardInterrupt | None:
    """The last interruption, unless a search has answered it with its best."""
    stop = _Last.stop
    return None if stop is None or was_answered(stop) else stop


def _wait(reader: int) -> None:
    while signals := os.read(reader, 64):
        began = time.monotonic()
        time.sleep(PATIENCE)
        for number in ENDS.keys() & set(signals):
            if _Last.noticed < began - PATIENCE:
                _end_now(number, "during a long step")


def _end_now(number: int, when: str) -> NoReturn:
    """End without returning to what the command is doing."""
    remove_unfinished()
    best, (code, what) = best_so_far(), ENDS[signal.Signals(number)]
    come_to = f", planning had come to {best}" if best else ""
    line = f"{what} {when}{come_to}; written files are complete, start again"
    with suppress(OSError):  # standard error may be closed, or on a full disk
        os.write(2, f"stratawalk: error: {line}\n".encode())
    os._exit(code)
