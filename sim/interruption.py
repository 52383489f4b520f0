"""Ctrl-C, SIGTERM, SIGHUP and SIGXCPU: how the command answers, whatever it is doing.

The first signal raises an exception where the command is, so that it can save what it
has; the second ends it at once. A library may turn that exception into an error of its
own, which `meant` undoes. Where a library is busy for long without returning to Python,
a thread that waits beside ends the command.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from math import inf
from types import FrameType
from typing import NoReturn

from planner import support
from sim.endings import ENDS, heeded, way_on

NOTICE_TIME = 0.6  # [s] in which the command has to notice a signal


class Terminated(KeyboardInterrupt):
    """SIGTERM, raised where it arrives as Ctrl-C raises KeyboardInterrupt."""


class HungUp(KeyboardInterrupt):
    """SIGHUP, as `Terminated`: the terminal is gone, an ssh was dropped."""


class OutOfTime(KeyboardInterrupt):
    """SIGXCPU, as `Terminated`: the processor time that was granted is used up."""


RAISED = {signal.SIGTERM: Terminated, signal.SIGHUP: HungUp, signal.SIGXCPU: OutOfTime}

_noticed = [-NOTICE_TIME]  # when the command noticed the last signal [s]


@contextmanager
def listening() -> Iterator[None]:
    """Answer signals meanwhile; afterwards whoever answered them before does again.

    Whoever sends SIGINT to a background job means it. Only the main thread may handle
    signals; in another one nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    support.forget_interruption()
    before = {number: signal.signal(number, _raise) for number in heeded()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)  # None: not of Python's
        support.forget_interruption()


def watch() -> None:
    """Start the thread that ends the command where it does not notice a signal."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=_wait, args=(reader,), daemon=True).start()
    sys.unraisablehook = _unnoticed


@contextmanager
def processor_time(seconds: float, error: Exception) -> Iterator[None]:
    """Raise an error in a block in which this process has computed for so long.

    Only the main thread may handle signals; in another one nothing is limited.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> NoReturn:
        raise error

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds, 1.0)  # again if a library hides it
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before or signal.SIG_DFL)


@contextmanager
def deaf(to: Iterable[signal.Signals] = ENDS) -> Iterator[None]:
    """Start processes that leave it to this one to answer signals, and to end them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, to)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def meant(error: BaseException) -> BaseException:
    """The interruption or the want of memory that an error stands for, or the error.

    Libraries written in C answer an exception raised inside them with one of their own,
    for example that an import failed.
    """
    stop = support.unanswered_interruption()
    if type(error).__name__ == "FatalError" and "allocate memory" in str(error):
        error = MemoryError()  # which MuJoCo has noticed
    if stop is None or isinstance(error, KeyboardInterrupt):
        return error
    for note in getattr(error, "__notes__", ()):
        stop.add_note(note)
    return stop


def _raise(number: int, frame: FrameType | None) -> NoReturn:
    _noticed[0] = time.monotonic()
    if support.unanswered_interruption() is not None:
        _end_now(number, "for the second time")
    stop = RAISED.get(signal.Signals(number), KeyboardInterrupt)()
    support.note_interruption(stop, _say_that_work_goes_on)
    raise stop


def _say_that_work_goes_on() -> None:
    _noticed[0] = time.monotonic()
    line = "Ctrl-C ended the search, whose best plan is taken; press it again to end"
    print(f"stratawalk: warning: {line}", file=sys.stderr)


def _wait(reader: int) -> None:
    while signals := os.read(reader, 64):
        began = time.monotonic()
        time.sleep(NOTICE_TIME)
        for number in ENDS.keys() & set(signals):
            if _noticed[0] < began - NOTICE_TIME:
                _end_now(number, "during a long step")


def _unnoticed(lost: "sys.UnraisableHookArgs") -> None:
    """An exception that Python drops, in a destructor for one, has ended nothing."""
    if not issubclass(lost.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
    elif support.unanswered_interruption() is not None:
        _noticed[0] = -inf


def _end_now(number: int, when: str) -> NoReturn:
    """End without returning to what the command is doing."""
    support.remove_unfinished()
    best, (code, what) = support.best_so_far(), ENDS[signal.Signals(number)]
    come_to = f", planning had come to {best}" if best else ""
    line = f"{what} {when}{come_to}; {way_on()}"
    with suppress(OSError):  # standard error may be closed, or on a full disk
        os.write(2, f"stratawalk: error: {line}\n".encode())
    os._exit(code)
