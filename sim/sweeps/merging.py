"""Shards of one sweep, joined to the table that a single process would have made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.errors import FilesError, UsageError
from sim.folder import RunFolder, ensure_folder
from sim.sweeps.folder import Shard, SweepFolder, read_about, sweep_from
from sim.sweeps.identity import differences
from sim.sweeps.ledger import Outcome, opened, read_ledger
from sim.sweeps.sweeping import Result, points_of, result
from sim.sweeps.table import write_table


def merge(sources: Sequence[Path], out: Path) -> tuple[Result, Path]:
    """Join the shards of a sweep.

    Args:
        sources: Folders of shards; one may hold several.
        out: Folder for the table and the whole ledger, which may be one of them.

    Returns:
        What became of the sweep, and the table's path.

    Raises:
        UsageError: If they are not of one sweep, or points are missing.
        FilesError: If a folder cannot be read or written.
    """
    told, known = _told(sources), _known(sources)
    points = points_of(sweep_from(told["asked"]), Shard())
    missing = [point for point, code in points.digests.items() if code not in known]
    if missing:
        few = ", ".join(map(str, missing[:5])) + ", ..." * (len(missing) > 5)
        raise UsageError(
            f"{len(missing)} of {len(points.digests)} points are missing: {few}",
            ", ".join(map(str, sources)),
            "walk them with `stratawalk sweep --resume`, or name the other shards",
        )
    folder = SweepFolder(ensure_folder(out))
    with opened(folder.ledger) as ledger:
        written = read_ledger(folder.ledger)
        ledger.add([o for code, o in known.items() if code not in written])
    RunFolder(out).write_json(folder.about.name, told)
    write_table(folder.table, list(points.rows(known)), told)
    return result(points.digests, known, 0), folder.table


def _told(sources: Sequence[Path]) -> dict[str, Any]:
    """What all shards are about, once they are found to agree."""
    found = {path: read_about(path) for s in sources for path in s.glob("sweep*.json")}
    for source in sources:
        if not any(path.parent == source for path in found):
            raise UsageError("no sweep", str(source), "give the folder of a sweep")
    first, *others = found.items()
    for path, told in others:
        if differ := differences(first[1] or {}, told or {}):
            raise UsageError(
                f"not of one sweep, {'; '.join(differ)}",
                f"{first[0]} and {path}",
                "merge shards of the same file and software",
            )
    told = first[1]
    if told is None:
        raise FilesError("cannot be read", str(first[0]), "restore it")
    return told


def _known(sources: Sequence[Path]) -> dict[str, Outcome]:
    known: dict[str, Outcome] = {}
    for source in sources:
        for path in sorted(source.glob("ledger*.jsonl")):
            known |= read_ledger(path)
    return known
