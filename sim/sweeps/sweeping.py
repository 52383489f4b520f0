"""The main job of a sweep: walk the points that are not done, and write the table.

Shards of one sweep are merged into the table that a single process would have written.
"""

import json
import shutil
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import count
from pathlib import Path
from time import process_time

from models import load, shipped_robots
from models.morphology import geometry_of
from planner.support import did_you_mean
from sim.endings import command
from sim.errors import FilesError, UsageError, one_line
from sim.folder import RunFolder, ensure_folder, require_free
from sim.preparation.shared import PLAN
from sim.run_folder import run
from sim.scenarios.file import to_table
from sim.scenarios.scenario import Scenario
from sim.sweeps.file import Sweep
from sim.sweeps.folder import (
    POINT,
    About,
    Shard,
    SweepFolder,
    abouts,
    point_in,
    run_folder,
    shards_in,
    sole_owner,
)
from sim.sweeps.ledger import OK, Outcome, digest, opened, read_ledger
from sim.sweeps.table import Row, write_table
from sim.sweeps.worker_pool import Task, open_pool

MOST_TEXT = 10**8  # letters of the scenarios of all points, checked in half a minute
MOST_TIME, SURE = 300.0, 5.0  # [s] of checking all points; known after so long
GOLDEN = (5**0.5 - 1) / 2  # whose multiples leave no large gap in the unit interval
Show = Callable[[int, int, int], None]  # given the points done, failed, and all


@dataclass(frozen=True, slots=True)
class Result:
    """What became of a sweep."""

    points: int  # those of this shard
    failed: int  # points without numbers
    reasons: Mapping[str, int]  # how many points failed of each, most frequent first
    walked: int  # now; the others were done already
    verdicts: Mapping[str, int]  # how many walks ended with each


@dataclass(frozen=True)
class Points:
    """The points of a sweep, or of a shard of it."""

    sweep: Sweep
    tables: Mapping[int, Mapping[str, object]]  # the scenario of each, in plain values
    digests: Mapping[int, str]  # of each point's settings; those of equal points agree
    plans: Mapping[int, int]  # the first point that has the same plan as each

    def known(self, about: About, *ledgers: Path) -> dict[str, Outcome]:
        """Outcomes that ledgers have, of one software unless the sweep is mixed."""
        software = None if about.mixed else about.software
        numbers = {code: point for point, code in self.digests.items()}
        return read_ledger(*ledgers, software=software, points=numbers)

    def tasks(self, known: Mapping[str, Outcome]) -> list[Task]:
        """What is to be walked; walks of one plan come one after another.

        Otherwise the first points are spread over all, to tell how long the rest takes.
        """
        todo = {d: p for p, d in self.digests.items() if d not in known}.values()
        place = {p: (GOLDEN * self.plans[p] % 1.0, GOLDEN * p % 1.0) for p in todo}
        order = sorted(todo, key=place.__getitem__)
        without = self.sweep.without
        named = self.sweep.at(0).given  # which the sweep gives beside its scenario
        return [Task(self.digests[p], self.tables[p], without, named) for p in order]

    def rows(self, known: Mapping[str, Outcome]) -> Iterator[Row]:
        """Rows of the table from the outcomes of all points, by their digests."""
        for point, code in self.digests.items():
            varied, outcome = self.sweep.varied(point), known[code]
            own = {"point": point, **varied, "status": outcome.status}
            yield own | {k: v for k, v in outcome.numbers.items() if k not in own}

    def result(self, known: Mapping[str, Outcome], walked: int = 0) -> Result:
        """What became of a sweep whose points are all done, some of them now."""
        reasons = Counter(known[code].status for code in self.digests.values())
        del reasons[OK]
        ranked = dict(reasons.most_common())
        words = [known[code].numbers.get("verdict") for code in self.digests.values()]
        verdicts = {"arrived": 0, **Counter(str(word) for word in words if word)}
        return Result(len(self.digests), reasons.total(), ranked, walked, verdicts)


def points_of(sweep: Sweep, shard: Shard) -> Points:
    """All points of a shard; impossible settings of one are refused."""
    numbers = [point for point in range(len(sweep)) if point in shard]
    scenarios, tables, size = dict[int, Scenario](), dict[int, Row](), 0
    began = process_time()
    for done, n in enumerate(numbers, start=1):
        scenarios[n] = sweep.at(n)
        tables[n] = to_table(scenarios[n])
        size += len(repr(tables[n]))
        time = (process_time() - began) / MOST_TIME
        share = max(size / MOST_TEXT, time * (time > SURE / MOST_TIME))
        if share * len(numbers) > done:
            facts = {"count": len(numbers), "most": int(done / share)}
            raise UsageError.of("points", f"sweep {sweep.name!r}", **facts)
    shapes = {(s.robot, *(s.geometry or ())) for s in scenarios.values()}
    for robot, *names in sorted(shapes):  # refused beforehand
        if not Path(robot).is_file():
            load(robot)  # which finds shipped ones alone
        known = geometry_of(robot) if robot in shipped_robots() else names
        for name in (name for name in names if name not in known):
            what = f"unknown number geometry.{name} of {robot}"
            raise UsageError(what, "the sweep's file", did_you_mean(name, known))
    first: dict[Hashable, int] = {}  # point of a plan; others differ in physics alone
    return Points(
        sweep,
        tables,
        {n: digest(scenario, sweep.without) for n, scenario in scenarios.items()},
        {n: first.setdefault(s.key(*PLAN), n) for n, s in scenarios.items()},
    )


def carry_on(
    points: Points,
    folder: SweepFolder,
    workers: int = 1,
    scheduler: str | None = None,
    *,
    mix: bool = False,
    show: Show = lambda done, failed, points: None,
) -> Result:
    """Walk what is not done yet of a sweep, and write its table.

    Workers are processes here, or those of a Dask scheduler at an address. Refused
    where another process works in the folder, or where it holds another sweep or points
    of other versions, unless these are to be mixed in one table.
    """
    times, done, failed = Counter(points.digests.values()), 0, 0

    def count(outcomes: Iterable[Outcome]) -> None:
        nonlocal done, failed
        for outcome in outcomes:
            done += times[outcome.digest]
            failed += times[outcome.digest] * (outcome.status != OK)
        show(done, failed, len(points.digests))

    with sole_owner(folder.lock):
        about = folder.agree(About.of(points.sweep), mix)
        known = points.known(about, folder.ledger)
        known = {code: one for code, one in known.items() if not one.died}
        if tasks := points.tasks(known):
            count(known.values())
            with (
                opened(folder.ledger) as ledger,
                open_pool(min(workers, len(tasks)), scheduler) as pool,
            ):
                for outcome in pool.carry_out(tasks):
                    ledger.add([outcome])
                    known[outcome.digest] = outcome
                    count([outcome])
        write_table(folder.table, list(points.rows(known)), asdict(about))
    return points.result(known, len(tasks))


def write_run_folders(points: Points, folder: SweepFolder) -> list[str]:
    """Walk the chosen points once more, each into a run folder of its own.

    Those that are complete, and of what the point is now, are left alone, or filmed;
    others of finished walks are set aside. The result says what went wrong with which.
    """
    own, wrong = RunFolder(folder.path), []
    if (runs := (own.path / run_folder(0)).parent).is_symlink():
        raise UsageError.of("link", runs, remedy="remove it")
    last = "video.mp4" if points.sweep.filmed else "summary.json"
    with sole_owner(folder.lock):
        for point in points.sweep.run_folders:
            at = own.path / run_folder(point)
            if point not in points.tables:
                continue
            now = {"of": points.digests[point], "varied": points.sweep.varied(point)}
            walked = point_in(at) == json.loads(json.dumps(now))
            if walked and (at / last).exists():
                continue
            scenario = points.sweep.at(point)
            try:
                if not walked:
                    if digest(scenario, points.sweep.without) != now["of"]:
                        raise UsageError.of("other_files", str(scenario.robot))
                    _clear(at)
                    inner = own.inner(run_folder(point))
                    run(scenario, inner, without=points.sweep.without)
                    inner.write_json(POINT, now)
                if points.sweep.filmed:
                    from sim.pictures.run_film import film_folder

                    film_folder(at)
            except FilesError:
                raise
            except Exception as error:  # its reason stands in the table as well
                wrong.append(f"point {point}: {one_line(error)}")
    return wrong


def _clear(folder: Path) -> None:
    """Remove a walk that was not finished, and set aside what else has its name."""
    if (folder / "scenario.toml").exists() and not (folder / "summary.json").exists():
        shutil.rmtree(folder, ignore_errors=True)
    elif folder.exists():
        others = (folder.with_suffix(f".{number}") for number in count(1))
        folder.rename(next(path for path in others if not path.exists()))


def merge(sources: Sequence[Path], out: Path) -> tuple[Result, Path]:
    """Join the shards of a sweep to one ledger and one table, whose path is returned.

    A folder may hold several shards, and be the one that the table is written to.
    Shards that are not of one sweep, or that lack points, are refused, and so is the
    folder of another sweep, or of a table that is not known to be of this one.
    """
    folder, into = SweepFolder(out), [out] if abouts(out) else []
    if not into:
        require_free(folder.table, "--out")
    about = _common_about([*sources, *into])
    points = points_of(about.sweep, Shard())
    ledgers = [path for at in sources for path in sorted(at.glob("ledger*.jsonl"))]
    known = points.known(about, *dict.fromkeys([*ledgers, folder.ledger]))
    missing = [point for point, code in points.digests.items() if code not in known]
    if missing:
        few = ", ".join(map(str, missing[:5])) + ", ..." * (len(missing) > 5)
        shards = [f"{missing[0] % n + 1}/{n}" for n in sorted(shards_in(sources))]
        part = ["--shard", shards[0]] if shards else []
        on = command("sweep", "FILE.toml", "--out", sources[0], *part, "--resume")
        facts = {"count": len(missing), "all": len(points.digests), "few": few}
        where = ", ".join(map(str, sources))
        raise UsageError.of("lacking_points", where, on=on, **facts)
    ensure_folder(out)
    with sole_owner(folder.lock), opened(folder.ledger) as ledger:
        written = points.known(about, folder.ledger)
        ledger.add([o for c, o in known.items() if c not in written or written[c].died])
        about = folder.agree(about, mix=about.mixed)
        write_table(folder.table, list(points.rows(known)), asdict(about))
    return points.result(known), folder.table


def _common_about(sources: Sequence[Path]) -> About:
    """What all shards are about, once they are found to agree."""
    found: dict[Path, About] = {}
    for source in sources:
        if not (paths := abouts(source)):
            raise UsageError("no sweep", str(source), "give the folder of a sweep")
        for path in paths:
            if (about := About.read(path)) is None:
                raise FilesError("cannot be read", str(path), "restore it")
            found[path] = about
    (first, about), *others = found.items()
    for path, other in others:
        if differ := about.differences(other):
            both, facts = f"{first} and {path}", "; ".join(differ)
            raise UsageError.of("not_one", both, differ=facts)
    return replace(about, mixed=any(one.mixed for one in found.values()))
