"""The ledger of a sweep: a line a finished point, and nothing is ever taken back.

A line is on the disk before its point counts as done. Whatever ends the process, every
line but the last is whole; a torn last line is cut off when the ledger is next opened,
and its point is walked again. A line begins with a seal, the digest of the rest of it:
one that somebody has changed is refused.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

from planner.support import open_file
from sim.errors import FilesError, UsageError

OK = "ok"
SEAL = b'{"seal": "%b", '
LENGTH = len(SEAL % bytes(16))
LONGEST_LINE = 10**6  # bytes of a line
INT64 = 2**63  # beyond the numbers that a table takes


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a point."""

    digest: str  # of its settings
    status: str  # `ok`, or the reason why it has no numbers
    numbers: Mapping[str, object] = field(default_factory=dict)  # by dotted names
    software: Mapping[str, str] = field(default_factory=dict)  # that they come from

    def __post_init__(self) -> None:
        words = self.digest, self.status, *self.software.values(), *self.numbers
        numbers = self.numbers.values()
        if not (all(map(_is_text, words)) and all(map(_is_plain, numbers))):
            raise TypeError("its texts or numbers are none")

    @property
    def line(self) -> bytes:
        """The line of the ledger that says so."""
        return _sealed(json.dumps(asdict(self)).encode())

    @classmethod
    def read(cls, line: bytes) -> Outcome:
        """What a line says; a ValueError if it is not as it was written."""
        content = b"{" + line[LENGTH:-1]
        if line != _sealed(content):
            raise ValueError("it was changed since")
        try:
            return cls(**json.loads(content))
        except (TypeError, AttributeError, RecursionError) as error:
            raise ValueError(str(error)) from error


class Ledger:
    """A ledger that is open for writing."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    def add(self, outcomes: Iterable[Outcome]) -> None:
        """Write lines and wait until they are on the disk."""
        content = b"".join(one.line for one in outcomes)
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
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW
        handle = os.open(path, flags, 0o666)
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

    A torn last line counts as not written, and its point is walked again.
    """
    known: dict[str, Outcome] = {}
    with suppress(FileNotFoundError), open_file(path) as file:
        lines = iter(lambda: file.readline(LONGEST_LINE), b"")
        for number, line in enumerate(lines, start=1):
            if not line.endswith(b"\n") and len(line) < LONGEST_LINE:
                break
            try:
                outcome = Outcome.read(line)
            except ValueError as error:
                what = f"line {number} is not as a sweep wrote it, {error}"
                remedy = "delete that line; --resume walks its point again"
                raise UsageError(what, str(path), remedy) from error
            known[outcome.digest] = outcome
    return known


def _sealed(content: bytes) -> bytes:
    """A line that holds a JSON object, with the first digits of its digest in front."""
    digest = hashlib.sha256(content).hexdigest()[:16]
    return SEAL % digest.encode() + content[1:] + b"\n"


def _is_plain(value: object) -> bool:
    """Whether a table has room for a value: a number, a text, yes or no, or nothing."""
    if isinstance(value, int | float):
        return abs(value) < INT64
    return value is None or _is_text(value)


def _is_text(value: object) -> bool:
    """Whether a value is a text without halves of characters, which no file takes."""
    return isinstance(value, str) and value.encode(errors="replace").decode() == value
