"""Progress of long work: a bar on a terminal, nothing in a pipe.

A terminal shows no bar if it cannot draw one or its user wants plain text: `TERM` is
`dumb`, or `NO_COLOR` is set to anything at all (no-color.org).
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str, float], None]
"""Called with the name of a stage and the finished part of it, from 0 to 1."""


def silent(stage: str, fraction: float) -> None:
    """Show nothing."""


def may_draw() -> bool:
    """Whether standard error is a terminal whose user wants bars."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stderr.isatty() and not plain


@contextmanager
def bar(quiet: bool = False) -> Iterator[Progress]:
    """A bar for each stage on standard error, if that is a terminal that may draw it.

    Args:
        quiet: Show nothing even on a terminal.
    """
    if quiet or not may_draw():
        yield silent
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
