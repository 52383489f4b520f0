"""Progress of long work: bars on a terminal, a line now and then elsewhere.

A terminal shows no bar if it cannot draw one or its user wants plain text: `TERM` is
`dumb`, or `NO_COLOR` is set to anything at all (no-color.org).
"""

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


def say(line: str, number: int = 2) -> None:
    """Print a line on standard error, or output; work goes on where nobody hears it."""
    try:
        print(line, file=sys.stdout if number == 1 else sys.stderr, flush=True)
    except OSError as error:
        if number == 1 and not isinstance(error, BrokenPipeError):
            raise  # a full disk may lose no results
        os.dup2(os.open(os.devnull, os.O_WRONLY), number)


class Pace:
    """When a stage will end, by the pace of the later half of what is done.

    What comes first is slower where processes start, and a part that takes long does
    not count as standing still.
    """

    def __init__(self, now: float) -> None:
        self.began, self.fraction = now, 0.0
        self._reports = [(0.0, now)]

    def report(self, fraction: float, now: float) -> None:
        """Note how far the stage is, which may begin anew once it has ended."""
        if self.fraction >= 1 > fraction:
            self.began, self.fraction, self._reports = now, 0.0, [(0.0, now)]
        if fraction > self.fraction:
            self.fraction = fraction
            self._reports.append((fraction, now))

    def left(self, now: float) -> str:
        """How long the stage will take, in words; empty where it is not known."""
        if not TELLING <= self.fraction < 1:
            return ""
        part, at = self._reports[-1]
        since, then = [r for r in self._reports if r[0] <= part / 2][-1]
        rest = (1 - part) * (at - then) / (part - since) - (now - at)
        return f"about {max(rest, 1.0):.0f} s left"


def _name(stage: str) -> str:
    return stage.partition(",")[0]


class Lines:
    """A plain line about the present stage, on standard error, every few seconds."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.clock, self._told = clock, clock()
        self._paces: dict[str, Pace] = {}
        self._stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        """Say how far a stage is, if nothing was said for a while."""
        self._stage, now = stage, self.clock()
        self._paces.setdefault(_name(stage), Pace(now)).report(fraction, now)
        self.remind()

    def remind(self) -> None:
        """Say what is being done, if nothing was said for a while."""
        now, pace = self.clock(), self._paces.get(_name(self._stage))
        if pace is None or now - self._told < PATIENCE or pace.fraction >= 1:
            return
        self._told = now
        about = pace.left(now) or f"{now - pace.began:.0f} s so far"
        part = f" {pace.fraction:4.0%}" if pace.fraction else ""
        say(f"{self._stage}{part}, {about}")


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
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return _bars() if sys.stderr.isatty() and not plain else _reminded()


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
    with rich.Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        tasks: dict[str, rich.TaskID] = {}
        paces: dict[str, Pace] = {}

        def show(stage: str, fraction: float) -> None:
            if (name := _name(stage)) not in tasks:
                paces[name] = Pace(time.monotonic())
                tasks[name] = bars.add_task(stage, total=None, part="", left="")
            if fraction > 0:
                paces[name].report(fraction, time.monotonic())
                bars.update(
                    tasks[name],
                    description=stage,
                    total=1.0,
                    completed=fraction,
                    part=f"{fraction:.0%}",
                    left=paces[name].left(time.monotonic()),
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
