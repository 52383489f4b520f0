"""Files that appear under their name only once they are complete and on the disk."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_unfinished: set[Path] = set()


@contextmanager
def whole_file(path: Path | str, size: int = 0) -> Iterator[Path]:
    """A file that is written as a whole or not at all.

    The block writes to the path that it is given. That file takes the name `path` when
    the block has succeeded, and is removed when it has not. It lies in the same folder
    and has the same suffix, from which writers tell the format.

    Args:
        path: Name of the file, in a folder that exists.
        size: Number of bytes that will be written, as far as it is known.

    Raises:
        OSError: The disk is full, or the folder cannot be written; `filename` is the
            name of the file.
    """
    path = Path(path)
    part = path.parent / f".{path.stem}.{os.getpid()}.part{path.suffix}"
    _unfinished.add(part)
    try:
        require_space(path.parent, size)
        yield part
        _flush(part)
        os.replace(part, path)
        _flush(path.parent)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OSError(error.errno, reason, str(path)) from error
    finally:
        with suppress(OSError):
            part.unlink()
        _unfinished.discard(part)


def remove_unfinished() -> None:
    """Remove the files that are being written, before a process ends at once."""
    for part in list(_unfinished):
        with suppress(OSError):
            part.unlink()


def require_space(folder: Path, size: int) -> None:
    """Refuse to write what the disk has no room for.

    Args:
        folder: Folder that exists, on the disk in question.
        size: Number of bytes that will be written.

    Raises:
        OSError: The disk has less room than that.
    """
    if shutil.disk_usage(folder).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))


def _flush(path: Path) -> None:
    """Wait until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
