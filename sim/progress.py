"""Progress of long work: bars on a terminal, a line now and then elsewhere.

A terminal shows no bar if it cannot draw one or its user wants plain text: `TERM` is
`dumb`, or `NO_COLOR` is set to anything at all (no-color.org).
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

Progress = Callable[[str, float], None]
"""Called with the name of a stage and the finished part of it, from 0 to 1."""

PATIENCE = 15.0  # [s] between lines where there is no bar
TELLING = 0.05  # part of a stage from which on its end can be estimated


def silent(stage: str, fraction: float) -> None:
    """Show nothing."""


def may_draw() -> bool:
    """Whether standard error is a terminal that may show bars."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stderr.isatty() and not plain


@dataclass
class Lines:
    """A plain line about the present stage, on standard error, every few seconds.

    Attributes:
        clock: Gives the time [s].
    """

    clock: Callable[[], float] = time.monotonic
    _began: dict[str, float] = field(default_factory=dict)
    _told: float = field(init=False)

    def __post_init__(self) -> None:
        self._told = self.clock()

    def __call__(self, stage: str, fraction: float) -> None:
        """Say how far a stage is, if nothing was said for a while."""
        now = self.clock()
        began = self._began.setdefault(stage, now)
        if now - self._told < PATIENCE or fraction >= 1:
            return
        self._told = now
        left = (now - began) * (1 - fraction) / max(fraction, TELLING)
        about = f", about {left:.0f} s left" if fraction >= TELLING else ""
        print(f"{stage} {fraction:4.0%}{about}", file=sys.stderr, flush=True)


@contextmanager
def bar(quiet: bool = False) -> Iterator[Progress]:
    """A bar for each stage on standard error, or lines where it draws no bars.

    Args:
        quiet: Show nothing at all.
    """
    if quiet:
        yield silent
        return
    if not may_draw():
        yield Lines()
        return
    from rich.console import Console
    from rich.progress import Progress as Bars, TaskID

    with Bars(console=Console(stderr=True), transient=True) as bars:
        tasks: dict[str, TaskID] = {}

        def show(stage: str, fraction: float) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage, total=1.0)
            bars.update(tasks[stage], completed=fraction)

        yield show


@contextmanager
def stage(progress: Progress, name: str) -> Iterator[None]:
    """A stage whose parts are not counted: it has begun, and it has ended.

    Args:
        progress: Where it is shown.
        name: Of the stage.
    """
    progress(name, 0.0)
    yield
    progress(name, 1.0)
