"""The main job of a sweep: walk the points that are not done, and write the table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from models import shipped_robots
from models.morphology import geometry_of
from planner.support import did_you_mean
from sim.errors import UsageError
from sim.preparation.shared import PLAN
from sim.scenarios.file import to_table
from sim.scenarios.scenario import Scenario
from sim.sweeps.file import Sweep
from sim.sweeps.folder import Shard, SweepFolder, about, agree
from sim.sweeps.identity import digest
from sim.sweeps.ledger import OK, Outcome, opened, read_ledger
from sim.sweeps.lock import sole_owner
from sim.sweeps.table import write_table
from sim.sweeps.worker_pool import Task, open_pool


@dataclass(frozen=True, slots=True)
class Workforce:
    """Who walks the points.

    Attributes:
        workers: Processes on this machine.
        scheduler: Address of a Dask scheduler whose workers are taken instead.
    """

    workers: int = 1
    scheduler: str | None = None


@dataclass(frozen=True, slots=True)
class Result:
    """What became of a sweep.

    Attributes:
        points: Number of points, those of this shard.
        failed: How many of them have no numbers.
        reasons: How many points failed of each reason, most frequent first.
        walked: How many were walked now; the others were done already.
    """

    points: int
    failed: int
    reasons: Mapping[str, int]
    walked: int


class Show(Protocol):
    """Shows how far a sweep has come."""

    def __call__(self, done: int, failed: int, points: int) -> None:
        """Called at the start and with each outcome."""
        ...


def show_nothing(done: int, failed: int, points: int) -> None:
    """Show nothing."""


@dataclass(frozen=True)
class Points:
    """The points of a sweep, or of a shard of it.

    Attributes:
        sweep: What the sweep's file says.
        tables: Scenario of each point, as a table of plain values.
        digests: Digest of each point's settings; equal points have equal ones.
        plans: The first point that has the same plan as each.
    """

    sweep: Sweep
    tables: Mapping[int, Mapping[str, Any]]
    digests: Mapping[int, str]
    plans: Mapping[int, int]

    def tasks(self, known: Container[str]) -> list[Task]:
        """What is to be walked; walks of one plan come one after another."""
        todo = {d: p for p, d in self.digests.items() if d not in known}
        order = sorted(todo.items(), key=lambda pair: (self.plans[pair[1]], pair[1]))
        return [Task(d, self.tables[p], self.sweep.without) for d, p in order]

    def rows(self, known: Mapping[str, Outcome]) -> Iterator[dict[str, Any]]:
        """Rows of the table.

        Args:
            known: Outcomes by digest, one for every point.
        """
        for point, code in self.digests.items():
            varied, outcome = self.sweep.varied(point), known[code]
            own = {"point": point, **varied, "status": outcome.status}
            yield own | {k: v for k, v in outcome.numbers.items() if k not in own}


def points_of(sweep: Sweep, shard: Shard) -> Points:
    """All points of a shard.

    Raises:
        UsageError: If the settings of one are impossible.
    """
    numbers = [point for point in range(len(sweep)) if point in shard]
    scenarios = {point: sweep.at(point) for point in numbers}
    shapes = {(s.robot, *(s.geometry or ())) for s in scenarios.values()}
    for robot, *names in sorted(shapes):
        _require_robot(robot, names)
    return Points(
        sweep,
        {point: to_table(scenario) for point, scenario in scenarios.items()},
        {point: digest(s, sweep.without) for point, s in scenarios.items()},
        _plans(scenarios),
    )


def _plans(scenarios: Mapping[int, Scenario]) -> dict[int, int]:
    """The first point that differs from each in its physics alone."""
    first: dict[Hashable, int] = {}
    return {
        point: first.setdefault(scenario.key(*PLAN), point)
        for point, scenario in scenarios.items()
    }


def carry_on(
    points: Points,
    folder: SweepFolder,
    workforce: Workforce,
    *,
    mix: bool = False,
    show: Show = show_nothing,
) -> Result:
    """Walk what is not done yet of a sweep, and write its table.

    Args:
        points: Those of the folder's shard.
        folder: Its folder.
        workforce: Who walks.
        mix: Whether the table may hold points of different sweeps and versions.
        show: Called with the number of points that are done.

    Raises:
        UsageError: If the folder holds another sweep, or no scheduler answers.
        FilesError: If another process works in the folder, or it cannot be written.
        SweepError: If there is no worker.
    """
    told = about(points.sweep)
    with sole_owner(folder.lock):
        agree(folder, told, mix)
        known = read_ledger(folder.ledger)
        tasks = points.tasks(known)
        if tasks:
            counter = PointCounter(points.digests, known, show)
            with opened(folder.ledger) as ledger, counter.told():
                for outcome in _outcomes(tasks, workforce):
                    ledger.add([outcome])
                    known[outcome.digest] = outcome
                    counter.add(outcome)
        write_table(folder.table, list(points.rows(known)), told)
    return result(points.digests, known, len(tasks))


def _outcomes(tasks: Sequence[Task], workforce: Workforce) -> Iterator[Outcome]:
    with open_pool(min(workforce.workers, len(tasks)), workforce.scheduler) as pool:
        yield from pool.carry_out(tasks)


class PointCounter:
    """Counts the points that are done."""

    def __init__(
        self, digests: Mapping[int, str], known: Mapping[str, Outcome], show: Show
    ) -> None:
        self._show = show
        self._count = Counter(digests.values())
        self._points = len(digests)
        done = [outcome for code, outcome in known.items() if code in self._count]
        self._done = self._failed = 0
        for outcome in done:
            self._note(outcome)
        show(self._done, self._failed, self._points)

    def add(self, outcome: Outcome) -> None:
        """One more is done."""
        self._note(outcome)
        self._show(self._done, self._failed, self._points)

    def _note(self, outcome: Outcome) -> None:
        times = self._count[outcome.digest]
        self._done += times
        self._failed += times * (outcome.status != OK)

    @contextmanager
    def told(self) -> Iterator[None]:
        """Have whatever ends the block say how far the sweep has come."""
        try:
            yield
        except KeyboardInterrupt as stop:
            far = f"{self._done} of {self._points} points are done"
            stop.add_note(f"{far}, go on with --resume")
            raise


def result(
    digests: Mapping[int, str], known: Mapping[str, Outcome], walked: int
) -> Result:
    """What became of a sweep whose points are all done.

    Args:
        digests: Digest of each point.
        known: Outcomes by digest.
        walked: How many were walked now.
    """
    wrong = [known[code].status for code in digests.values()]
    reasons = Counter(status for status in wrong if status != OK)
    return Result(len(digests), reasons.total(), dict(reasons.most_common()), walked)


def _require_robot(robot: str, names: Sequence[str]) -> None:
    """Refuse what cannot be found, a robot or a number of its shape, beforehand."""
    if robot.endswith(".xml"):
        if not Path(robot).is_file():
            raise UsageError("no such robot file", robot, "give one that exists")
    elif robot not in (shipped := shipped_robots()):
        what = f"unknown robot {robot!r}"
        raise UsageError(what, "the sweep's file", did_you_mean(robot, shipped))
    else:
        known = geometry_of(robot)
        for name in (name for name in names if name not in known):
            what = f"unknown number geometry.{name} of {robot}"
            raise UsageError(what, "the sweep's file", did_you_mean(name, known))
