"""The ledger of a sweep: a line a finished point, and nothing is ever taken back.

A line is on the disk before its point counts as done. Whatever ends the process, every
line but the last is whole; a torn last line is cut off when the ledger is next opened,
and its point is walked again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

from sim.errors import FilesError

OK = "ok"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a point."""

    digest: str  # of its settings
    status: str  # `ok`, or the reason why it has no numbers
    numbers: Mapping[str, object] = field(default_factory=dict)  # by dotted names
    software: Mapping[str, str] = field(default_factory=dict)  # that they come from


class Ledger:
    """A ledger that is open for writing."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    def add(self, outcomes: Iterable[Outcome]) -> None:
        """Write lines and wait until they are on the disk."""
        content = "".join(f"{json.dumps(asdict(one))}\n" for one in outcomes).encode()
        try:
            while content:
                content = content[os.write(self._handle, content) :]
            os.fsync(self._handle)
        except OSError as error:
            reason = f"cannot be written, {error.strerror}"
            remedy = "make room, and go on with --resume; finished points are kept"
            raise FilesError(reason, str(self._path), remedy) from error


@contextmanager
def opened(path: Path) -> Iterator[Ledger]:
    """A ledger to add to; a line that was torn is cut off first."""
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        os.ftruncate(handle, path.read_bytes().rfind(b"\n") + 1)
    except OSError as error:
        reason = f"cannot be opened, {error.strerror}"
        raise FilesError(reason, str(path), "choose another folder") from error
    try:
        yield Ledger(path, handle)
    finally:
        os.close(handle)


def read_ledger(path: Path) -> dict[str, Outcome]:
    """Finished points by their digests; none where there is no ledger yet.

    A line that cannot be read counts as not written: its point is walked again.
    """
    known: dict[str, Outcome] = {}
    with suppress(FileNotFoundError), path.open("rb") as file:
        for line in (line for line in file if line.endswith(b"\n")):
            with suppress(ValueError, TypeError):
                outcome = Outcome(**json.loads(line))
                known[outcome.digest] = outcome
    return known
