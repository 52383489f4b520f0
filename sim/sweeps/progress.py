"""The bar of a sweep: points a second, failures and the time that is left.

Where no bar can be drawn there is a plain line now and then.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from sim.progress import bar, may_draw
from sim.sweeps.sweeping import Show, show_nothing


@dataclass
class Pace:
    """Points a second, from the first that is finished on: workers are slow to start.

    Attributes:
        clock: Gives the time [s].
    """

    clock: Callable[[], float] = time.monotonic
    _known: int | None = field(default=None, init=False)
    _since: float | None = field(default=None, init=False)

    def __call__(self, done: int) -> float:
        """The pace so far, 0 until there is one.

        Args:
            done: Points that are done, those of an earlier process included.
        """
        now = self.clock()
        if self._known is None:
            self._known = done
        if self._since is None and done > self._known:
            self._known, self._since = done, now
        if self._since is None or now <= self._since:
            return 0.0
        return (done - self._known) / (now - self._since)


@contextmanager
def sweep_bar(quiet: bool = False) -> Iterator[Show]:
    """A bar on standard error, if that is a terminal that may draw it.

    Args:
        quiet: Show nothing at all.
    """
    if quiet:
        yield show_nothing
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
    pace = Pace()
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bars:
        task = bars.add_task("points", total=None, rate="", failed=0)

        def show(done: int, failed: int, points: int) -> None:
            said = f"{pace(done):.3g} a second"
            bars.update(task, completed=done, total=points, failed=failed, rate=said)

        yield show
