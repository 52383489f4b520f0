"""The bar of a sweep: points a second, failures and the time that is left.

Where no bar can be drawn there is a plain line now and then.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from sim.progress import bar, may_draw
from sim.sweeps.sweeping import Show, unseen


@contextmanager
def sweep_bar(quiet: bool = False) -> Iterator[Show]:
    """A bar on standard error, if that is a terminal that may draw it.

    Args:
        quiet: Show nothing at all.
    """
    if quiet:
        yield unseen
        return
    if not may_draw():
        with bar() as lines:
            yield lambda done, failed, points: lines("points", done / max(points, 1))
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("points"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}, {task.fields[failed]} failed, left"),
        TimeRemainingColumn(),
    )
    began, first = time.monotonic(), [-1]
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:
        task = bars.add_task("points", total=None, rate="", failed=0)

        def show(done: int, failed: int, points: int) -> None:
            if first[0] < 0:
                first[0] = done
            rate = (done - first[0]) / max(time.monotonic() - began, 1e-3)
            said = f"{rate:.3g} a second"
            bars.update(task, completed=done, total=points, failed=failed, rate=said)

        yield show
