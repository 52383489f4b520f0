"""The folder of a sweep: its files, what it is about, and the process that owns it.

A shard, a part of a sweep that one job of many walks, has files of its own in it. One
process at a time works on them. The system lets go of a lock when its owner ends,
however it ends; the lock of a process that is gone is therefore never in the way.
"""

import json
import os
import re
import socket
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from planner.support import read_file
from sim.errors import FilesError, UsageError, is_text, telling
from sim.folder import RunFolder, ensure_folder
from sim.runs.run import read_run
from sim.sweeps.file import Sweep, left_out
from sim.sweeps.ledger import ALIKE, alike, differences, software

UNREADABLE = (ValueError, KeyError, TypeError, AttributeError, RecursionError)
SIDE_BY_SIDE = " with "  # between keys that vary together
WALKED = re.compile(r"table-[0-9]+-of-([1-9][0-9]*)\.parquet")  # all of a shard
POINT = "point.json"  # in a run folder of a sweep: which of its points that is
OWN = re.compile(r"sweep(-\d+-of-\d+)?\.(json|lock|owner)")  # files of any shard


def run_folder(point: int) -> str:
    """Where in a sweep's folder the run of a point is, if it was to be kept."""
    return f"runs/point-{point:05d}"


def point_in(run: Path) -> dict[str, Any]:
    """Which point of a sweep a whole run is of, by digest and what varies; or {}."""
    with suppress(OSError, *UNREADABLE):
        return {} | json.loads(read_file(run / POINT)) if read_run(run) else {}
    return {}


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several equal parts of a sweep; the points are dealt out one by one."""

    number: int = 1
    count: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.count:
            facts = {"part": self.number, "of": self.count, "last": max(self.count, 1)}
            raise UsageError.of("no_part", "--shard", **facts)

    def __contains__(self, point: int) -> bool:
        return point % self.count == self.number - 1

    @property
    def suffix(self) -> str:
        """What the names of its files end with."""
        return "" if self.count == 1 else f"-{self.number}-of-{self.count}"


@dataclass(frozen=True)
class About:
    """What a sweep is about, and the software it was begun with, as JSON has them."""

    asked: Mapping[str, Any]  # scenario, fixed and varying settings, measures left out
    software: Mapping[str, str]
    mixed: bool = False  # whether points of other sweeps and software are kept

    def __post_init__(self) -> None:
        vary = self.asked["vary"]
        tables = self.software, self.asked["scenario"], self.asked["set"], vary
        lists = all(isinstance(values, list) for values in vary.values())
        named = all(map(is_text, map(self.software.get, ALIKE)))
        plain = all(isinstance(table, Mapping) for table in tables)
        if not (lists and named and plain and isinstance(self.mixed, bool)):
            raise TypeError("it does not say what a sweep is about")
        _ = self.sweep

    @classmethod
    def of(cls, sweep: Sweep) -> "About":
        """What a sweep is about, with the software of today."""
        vary = {
            SIDE_BY_SIDE.join(keys): [one if keys[1:] else one[0] for one in choices]
            for keys, choices in sweep.blocks
        }
        asked = {
            "scenario": dict(sweep.scenario),
            "set": dict(sweep.fixed),
            "vary": vary,
            "without": sweep.without,
        }
        try:
            return cls(json.loads(json.dumps(asked, allow_nan=False)), software())
        except (TypeError, ValueError) as error:
            remedy = "give numbers and texts, also where other values replace them"
            raise UsageError.at(f"sweep {sweep.name!r}", error, remedy) from error

    @classmethod
    def read(cls, path: Path) -> "About | None":
        """What the sweep of a folder is about; None where nothing says so yet."""
        with telling("cannot be read", path, "choose another folder"):
            try:
                found = json.loads(read_file(path))
                json.dumps(found, allow_nan=False, ensure_ascii=False).encode()
                return cls(**found)
            except FileNotFoundError:
                return None
            except UNREADABLE as error:
                raise UsageError.of("no_sweep", path) from error

    @property
    def sweep(self) -> Sweep:
        """The sweep itself, of which no point gets a run folder."""
        blocks = []
        for names, choices in self.asked["vary"].items():
            keys = tuple(names.split(SIDE_BY_SIDE))
            rows = [tuple(c) if keys[1:] else (c,) for c in choices]
            if any(len(row) != len(keys) for row in rows):
                raise ValueError(f"{names} has rows of another length")
            blocks.append((keys, rows))
        scenario, fixed = self.asked["scenario"], self.asked["set"]
        without = left_out(self.asked["without"])
        return Sweep("merged", scenario, fixed, tuple(blocks), without)

    def differences(self, other: "About") -> list[str]:
        """What another sweep is about instead, as `key: value, now value`.

        Machines may differ in what makes no number another one, such as their kernels.
        """
        software = differences(*alike(self.software, other.software))
        orders = [{"order": [*about.asked["vary"]]} for about in (self, other)]
        return (differences(self.asked, other.asked) or differences(*orders)) + software


@dataclass(frozen=True, slots=True)
class SweepFolder:
    """The files of a sweep, or of a shard of it."""

    path: Path
    shard: Shard = Shard()

    @property
    def ledger(self) -> Path:
        """A line a finished point."""
        return self.path / f"ledger{self.shard.suffix}.jsonl"

    @property
    def table(self) -> Path:
        """A row a point."""
        return self.path / f"table{self.shard.suffix}.parquet"

    @property
    def lock(self) -> Path:
        """Held by the process that works in here."""
        return self.path / f"sweep{self.shard.suffix}.lock"

    @property
    def about(self) -> Path:
        """What the sweep is about."""
        return self.path / f"sweep{self.shard.suffix}.json"

    def agree(self, about: About, mix: bool) -> About:
        """Write down what the sweep is about, once it is found to be what it was.

        A table may hold points of different sweeps and versions if it is to mix them;
        the result says so from then on.
        """
        before = About.read(self.about) or about
        if (differ := before.differences(about)) and not mix:
            raise UsageError.of("mixed", self.path, differ="; ".join(differ))
        about = replace(about, mixed=mix or before.mixed)
        RunFolder(self.path).write_json(self.about.name, asdict(about))
        return about


def abouts(folder: Path) -> list[Path]:
    """Files of a folder that say what its sweep, or each of its shards, is about."""
    names = os.listdir(folder) if folder.is_dir() else []  # which may be forbidden
    return [folder / n for n in names if OWN.fullmatch(n) and n.endswith(".json")]


def shards_in(folders: Iterable[Path]) -> set[int]:
    """In how many parts folders have a sweep, by the names of their tables."""
    names = (path.name for at in folders for path in at.glob("table-*"))
    return {int(found[1]) for name in names if (found := WALKED.fullmatch(name))}


def claim(out: Path, shard: Shard, resume: bool) -> SweepFolder:
    """Make the folder of a sweep, or resume the one that is there.

    Shards may share a folder. One that exists and is not to be resumed is refused.
    """
    folder = SweepFolder(out, shard)
    begun = folder.about.exists() or folder.ledger.exists()
    foreign = out.exists() and not begun
    if out.is_dir() and not begun:
        empty_will_do = resume or shard.count > 1
        there = [path.name for path in out.iterdir()]
        foreign = not (any(map(OWN.fullmatch, there)) or (empty_will_do and not there))
    if (begun and not resume) or foreign:
        remedy = "give --resume to go on with it" if begun else "choose another folder"
        raise UsageError("already exists", str(out), remedy)
    ensure_folder(out, "sweep's folder")
    return folder


@contextmanager
def sole_owner(path: Path) -> Iterator[None]:
    """Hold the lock in a file while the block runs; another owner is named and refused.

    What names the owner stays only where its process is killed.
    """
    lock, owner = FileLock(path, timeout=0), path.with_suffix(".owner")
    with telling("cannot be locked", path.parent, "let its files be written"):
        try:
            lock.acquire()
        except Timeout:
            who = "another process"
            with suppress(OSError, ValueError, KeyError, TypeError):
                found = json.loads(read_file(owner))
                who = f"process {found['pid']} on {found['host']}"
            raise FilesError.of("working", path.parent, who=who) from None
    try:
        me = {"pid": os.getpid(), "host": socket.gethostname()}
        RunFolder(owner.parent).write_json(owner.name, me)
        yield
    finally:
        owner.unlink(missing_ok=True)
        lock.release()
