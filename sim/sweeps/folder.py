"""The folder of a sweep: what it is about, its ledger and its table.

A shard, a part of a sweep that one job of many walks, has files of its own in it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.errors import FilesError, UsageError
from sim.folder import RunFolder, ensure_folder
from sim.sweeps.file import Sweep
from sim.sweeps.identity import differences, software

SIDE_BY_SIDE = " with "  # between keys that vary together


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several equal parts of a sweep; the points are dealt out one by one."""

    number: int = 1
    count: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.count:
            raise UsageError(
                f"there is no part {self.number} of {self.count}",
                "--shard",
                f"give I/N with I from 1 to {max(self.count, 1)}",
            )

    def __contains__(self, point: int) -> bool:
        return point % self.count == self.number - 1

    @property
    def suffix(self) -> str:
        """What the names of its files end with."""
        return "" if self.count == 1 else f"-{self.number}-of-{self.count}"


@dataclass(frozen=True, slots=True)
class SweepFolder:
    """Names of a sweep's files."""

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
        """What the sweep is about, and the software it was begun with."""
        return self.path / f"sweep{self.shard.suffix}.json"


def claim(out: Path, shard: Shard, resume: bool) -> SweepFolder:
    """Make the folder of a sweep, or go on in one.

    Args:
        out: Where; shards may share a folder.
        shard: Which part of the sweep.
        resume: Whether it may hold this part already.

    Raises:
        UsageError: If it exists and is not to be gone on with.
        FilesError: If it cannot be made.
    """
    folder = SweepFolder(out, shard)
    begun = folder.about.exists() or folder.ledger.exists()
    if (begun and not resume) or _strange(out, resume or shard.count > 1):
        remedy = "give --resume to go on with it" if begun else "choose another folder"
        raise UsageError("already exists", str(out), remedy)
    ensure_folder(out, "sweep's folder")
    return folder


def _strange(out: Path, empty_will_do: bool) -> bool:
    """Whether a path exists and is not the folder of a sweep."""
    if not out.is_dir():
        return out.exists()
    ours = any(out.glob("sweep*")) or (empty_will_do and not any(out.iterdir()))
    return not ours


def about(sweep: Sweep) -> dict[str, Any]:
    """What a sweep is about, and with which software."""
    blocks = {
        SIDE_BY_SIDE.join(keys): [
            list(choice) if len(keys) > 1 else choice[0] for choice in choices
        ]
        for keys, choices in sweep.blocks
    }
    asked = {
        "scenario": dict(sweep.scenario),
        "set": dict(sweep.fixed),
        "vary": blocks,
        "without": list(sweep.without),
    }
    return {"asked": asked, "software": software()}


def sweep_from(asked: Mapping[str, Any]) -> Sweep:
    """The sweep that a folder is about.

    Args:
        asked: What was written about it.
    """
    blocks = []
    for names, choices in asked["vary"].items():
        keys = tuple(names.split(SIDE_BY_SIDE))
        rows = [(one,) if len(keys) == 1 else tuple(one) for one in choices]
        blocks.append((keys, rows))
    return Sweep(
        name="merged",
        scenario=asked["scenario"],
        fixed=asked["set"],
        blocks=tuple(blocks),
        without=tuple(asked["without"]),
        kept=(),
        filmed=False,
    )


def agree(folder: SweepFolder, told: Mapping[str, Any], mix: bool) -> None:
    """Write down what a sweep is about, once it is found to be what it was.

    Args:
        folder: The sweep's folder.
        told: What it is about now.
        mix: Whether a table may hold points of different sweeps and versions.

    Raises:
        UsageError: If it was begun as something else, with what differs.
        FilesError: If the folder cannot be written.
    """
    told = json.loads(json.dumps(told))
    before = read_about(folder.about)
    if before == told:
        return
    if before is not None and not mix:
        differ = [d for part in told for d in differences(before[part], told[part])]
        raise UsageError(
            f"begun as something else, {'; '.join(differ)}",
            str(folder.path),
            "choose another folder, or mix them in one table with --force-mix",
        )
    RunFolder(folder.path).write_json(folder.about.name, told)


def read_about(path: Path) -> dict[str, Any] | None:
    """What a sweep is about; None where nothing says so yet.

    Args:
        path: File of a sweep's folder.

    Raises:
        FilesError: If it cannot be read.
    """
    try:
        told: dict[str, Any] = json.loads(path.read_text())
        return {"asked": told["asked"], "software": told["software"]}
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        what = f"cannot be read, {error}"
        raise FilesError(what, str(path), "choose another folder") from error
