"""Progress of long work: bars on a terminal, a line now and then elsewhere.

A terminal shows no bar if it cannot draw one or its user wants plain text: `TERM` is
`dumb`, or `NO_COLOR` is set to anything at all (no-color.org).
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from threading import Event, Thread

Progress = Callable[[str, float], None]
"""Called with the name of a stage and the finished part of it, from 0 to 1.

A stage at 0 has begun; how long it takes is not known yet. It is known by its words
before the first comma; those behind it may change.
"""

PATIENCE = 15.0  # [s] between lines where there is no bar
TELLING = 0.05  # part of a stage from which on its end can be estimated


def silent(stage: str, fraction: float) -> None:
    """Show nothing."""


def may_draw() -> bool:
    """Whether standard error is a terminal that may show bars."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stderr.isatty() and not plain


def left(spent: float, fraction: float) -> str:
    """How long a stage will take, after some time [s], in words; empty if unknown."""
    if not TELLING <= fraction < 1:
        return ""
    return f"about {spent * (1 - fraction) / fraction:.0f} s left"


def _name(stage: str) -> str:
    return stage.partition(",")[0]


class Lines:
    """A plain line about the present stage, on standard error, every few seconds."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.clock, self._told = clock, clock()
        self._began: dict[str, float] = {}
        self._stage, self._fraction = "", 1.0

    def __call__(self, stage: str, fraction: float) -> None:
        """Say how far a stage is, if nothing was said for a while."""
        self._stage, self._fraction = stage, fraction
        self._began.setdefault(_name(stage), self.clock())
        self.remind()

    def remind(self) -> None:
        """Say what is being done, if nothing was said for a while."""
        now, stage, fraction = self.clock(), self._stage, self._fraction
        if now - self._told < PATIENCE or fraction >= 1:
            return
        self._told, spent = now, now - self._began[_name(stage)]
        about = left(spent, fraction) or f"{spent:.0f} s so far"
        part = f" {fraction:4.0%}" if fraction else ""
        print(f"{stage}{part}, {about}", file=sys.stderr, flush=True)


@contextmanager
def _reminded() -> Iterator[Progress]:
    """Lines also about stages that say nothing of themselves."""
    lines, ended = Lines(), Event()

    def remind() -> None:
        while not ended.wait(1.0):
            lines.remind()

    Thread(target=remind, daemon=True).start()
    try:
        yield lines
    finally:
        ended.set()


def bar(quiet: bool = False) -> AbstractContextManager[Progress]:
    """A bar for each stage on standard error, or lines where it draws no bars."""
    if quiet:
        return nullcontext(silent)
    return _bars() if may_draw() else _reminded()


@contextmanager
def _bars() -> Iterator[Progress]:
    """Bars with the time since each stage began, and the time that is left."""
    from rich import progress as rich
    from rich.console import Console

    columns = (
        "{task.description}",
        rich.BarColumn(),
        "{task.fields[part]:>4}",
        rich.TimeElapsedColumn(),
        "{task.fields[left]}",
    )
    console = Console(stderr=True)
    with rich.Progress(*columns, console=console, transient=True) as bars:
        tasks: dict[str, rich.TaskID] = {}
        began: dict[str, float] = {}

        def show(stage: str, fraction: float) -> None:
            if (name := _name(stage)) not in tasks:
                began[name] = time.monotonic()
                tasks[name] = bars.add_task(stage, total=None, part="", left="")
            if fraction > 0:
                bars.update(
                    tasks[name],
                    description=stage,
                    total=1.0,
                    completed=fraction,
                    part=f"{fraction:.0%}",
                    left=left(time.monotonic() - began[name], fraction),
                )

        yield show


@contextmanager
def stage(progress: Progress, name: str) -> Iterator[None]:
    """A stage whose parts are not counted: it has begun, and it has ended."""
    progress(name, 0.0)
    yield
    progress(name, 1.0)


@contextmanager
def at_most(progress: Progress, name: str, seconds: float) -> Iterator[None]:
    """A search that may take so many seconds, or is ended; it mostly takes far less."""
    from planner.support import limited

    within = f"{name}, {seconds:g} s at most"
    with stage(progress, within), limited(seconds, lambda p: progress(within, p)):
        yield
