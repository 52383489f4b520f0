"""The folder of a run: files appear under their names once complete and on the disk."""

import csv
import io
import json
import os
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from fcntl import LOCK_EX, flock
from math import prod
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

import numpy as np

from planner.support import require_space, whole_file
from sim.endings import command
from sim.errors import FULL, ExitCode, FilesError, UsageError, exit_code, telling


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The folder of one run, its files complete; FilesError where none can be made."""

    path: Path
    parents: tuple[Path, ...] = ()  # that were made for it, the innermost first

    def write_text(self, name: str, text: str) -> None:
        """Write a text file."""
        self.write_bytes(name, text.encode())

    def write_bytes(self, name: str, content: bytes) -> None:
        """Write a file as it is, in a folder of its own if its name says so."""
        path = self.path / name
        if path.parent != self.path:
            path.parent.mkdir(parents=True, exist_ok=True)
        with whole(path, len(content)) as part:
            part.write_bytes(content)

    def write_json(self, name: str, value: Mapping[str, object]) -> None:
        """Write numbers unrounded; NaN and infinity, unknown to JSON, are refused."""
        self.write_text(name, json.dumps(value, indent=1, allow_nan=False) + "\n")

    def reserve(self, size: int) -> None:
        """Refuse to begin where the disk has less than `size` bytes."""
        with _writing(self.path, lambda: size):
            require_space(self.path, size)

    def write_arrays(
        self, name: str, arrays: "Iterable[tuple[str, np.ndarray | Pieces]]"
    ) -> None:
        """Write named arrays as compressed .npz; equal arrays give equal bytes."""
        arrays, size = iter(arrays), 0

        def at_most() -> int:
            return size + sum(_size(array) for _, array in arrays)

        with (
            whole(self.path / name, at_most=at_most) as part,
            zipfile.ZipFile(part, "w") as archive,
        ):
            for key, array in arrays:
                size += _size(array)
                member = zipfile.ZipInfo(f"{key}.npy")  # dated alike at all times
                member.compress_type = zipfile.ZIP_DEFLATED
                with archive.open(member, "w", force_zip64=True) as file:
                    _write_array(file, array)

    def inner(self, name: str) -> "RunFolder":
        """A new folder within this one."""
        with _writing(self.path / name):
            return RunFolder(_make(self.path / name))

    def discard_if_empty(self) -> None:
        """Remove the folder if nothing was written to it, and what was made for it."""
        for path in (self.path, *self.parents):
            with suppress(OSError):
                path.rmdir()


@dataclass(frozen=True, slots=True)
class Pieces:
    """An array of floats too long to hold, cut along its first axis."""

    shape: tuple[int, ...]
    pieces: Iterable[np.ndarray]


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """The text of a table, its names first, every digit of every number kept."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def csv_lines(text: str, parted: str = ",") -> Iterator[list[str]]:
    """Lines of a table's text; a csv.Error where cells go on behind quotes."""
    return csv.reader(io.StringIO(text, newline=""), delimiter=parted, strict=True)


def csv_rows(text: str, name: str) -> list[dict[str, str]]:
    """Rows of such a table by names; a ValueError where entries are missing."""
    lines = [line for line in csv_lines(text) if line]
    if len({len(line) for line in lines}) != 1:
        raise ValueError(f"{name} is incomplete")
    return [dict(zip(lines[0], line, strict=True)) for line in lines[1:]]


def _size(array: np.ndarray | Pieces) -> int:
    """Bytes that an array takes at most, compressed."""
    return array.nbytes if isinstance(array, np.ndarray) else 8 * prod(array.shape)


def _write_array(file: IO[bytes], array: np.ndarray | Pieces) -> None:
    if isinstance(array, np.ndarray):
        np.lib.format.write_array(file, array, allow_pickle=False)
        return
    described = {"descr": "<f8", "fortran_order": False, "shape": array.shape}
    np.lib.format.write_array_header_1_0(file, described)
    for piece in array.pieces:
        file.write(piece.astype("<f8").tobytes())


def claim(folder: Path | None, scenario: str) -> RunFolder:
    """Make a run's folder, a UsageError if it exists, or the next free in `runs`."""
    wanted = folder or Path("runs", scenario)
    _require_named(wanted)
    parents = tuple(p for p in wanted.parents if not os.path.exists(p))
    try:
        made = _make(folder) if folder else _next_free(Path("runs"), scenario)
    except OSError as error:
        if folder and os.path.lexists(folder):
            raise UsageError.of("taken", folder) from error
        reason, where = f"cannot make the run folder, {error.strerror}", error.filename
        raise FilesError(reason, str(where), "choose another with --out") from error
    claimed = RunFolder(made, parents)
    try:
        require_writable(made)
    except BaseException:  # an interruption, too, after which its name must be free
        claimed.discard_if_empty()
        raise
    return claimed


def ensure_folder(folder: Path, what: str = "folder") -> Path:
    """Make a folder, which a message calls `what`, unless it is there and writable."""
    _require_named(folder)
    with telling(f"cannot make the {what}", folder, "choose another with --out"):
        folder.mkdir(parents=True, exist_ok=True)
    require_writable(folder)
    return folder


def require_writable(folder: Path) -> None:
    """Refuse a folder, before any work for it, in which no file can be made."""
    with _writing(folder), TemporaryFile(dir=folder) as file:
        file.write(b"\n")


def new_file(path: Path, kind: str, *endings: str) -> Path:
    """A file to be made, which must be new, in a folder that is made for it."""
    if path.suffix not in endings:
        raise UsageError.of("file_name", path, kind=kind, endings=" or ".join(endings))
    require_free(path)
    ensure_folder(path.parent, f"{kind}'s folder")
    return path


def require_free(path: Path | str, option: str = "") -> None:
    """Refuse a name that a file, or a dead link, has already, or none can have."""
    with (
        telling("cannot be written", path, "give another name"),
        suppress(FileNotFoundError, NotADirectoryError),
    ):
        os.lstat(path)
        raise UsageError.of("in_use", path, option=f"{option} " * bool(option))


def _require_named(folder: Path) -> None:
    if "\\" in str(folder.absolute()):
        raise UsageError.of("backslash", folder.absolute())


def _make(folder: Path) -> Path:
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir()
    return folder


def _next_free(parent: Path, name: str) -> Path:
    """Number the folder; mkdir decides when two runs ask at once."""
    parent.mkdir(parents=True, exist_ok=True)
    numbered = re.compile(re.escape(name) + r"-(\d+)")
    taken = (numbered.fullmatch(entry.name) for entry in parent.iterdir())
    number = max((int(match[1]) for match in taken if match), default=0) + 1
    while True:
        with suppress(FileExistsError):
            return _make(parent / f"{name}-{number:03d}")
        number += 1


@contextmanager
def blamed_on(place: Path, remedy: str = "") -> Iterator[None]:
    """Refuse a finished run, or another place, in whose files anything goes wrong."""
    try:
        yield
    except Exception as error:
        if exit_code(error) is not ExitCode.BUG:
            raise
        what = "its files do not fit together, where --debug says"
        again = f"walk it again: {command('run', place / 'scenario.toml')}"
        raise UsageError(what, str(place), remedy or again) from error


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, for which others wait; some disks have no locks."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            flock(handle, LOCK_EX)
        yield
    finally:
        os.close(handle)


@contextmanager
def whole(
    path: Path,
    size: int = 0,
    at_most: Callable[[], int] | None = None,
    *,
    new: bool = False,
) -> Iterator[Path]:
    """A path to write to, which takes `path`'s name once the block has succeeded.

    The disk is asked for `size` bytes beforehand; if it is full after all, the message
    says that up to `at_most()` are needed. Where a file was to be `new`, the second of
    two at once is a UsageError.
    """
    needed, about = (at_most, "up to ") if at_most else (lambda: size, "")
    with _writing(path, needed, about), whole_file(path, size, new) as part:
        yield part


@contextmanager
def _writing(
    path: Path, needed: Callable[[], int] = lambda: 0, about: str = ""
) -> Iterator[None]:
    with telling("cannot be written", path, "choose a folder that can be written"):
        try:
            yield
        except FileExistsError as error:
            raise UsageError.of("exists", path) from error
        except OSError as error:
            if error.errno not in FULL:
                raise
            size = needed()
            room = f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.1f} kB"
            most = f", {about}{room} needed" if size else ""
            raise FilesError.of("full", path, most=most) from error
