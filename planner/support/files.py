"""Files that are written whole, and files of others that are read with care.

A file that is written appears under its name only once it is complete and on the disk.
Of files that others have made only those are read that come to an end.
"""

import errno
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path
from secrets import token_hex

LARGEST_TEXT = 10**7  # bytes of a text that somebody has written
_unfinished: set[Path] = set()


@contextmanager
def whole_file(path: Path | str, size: int = 0, new: bool = False) -> Iterator[Path]:
    """A file that is written as a whole or not at all.

    The block writes to the path that it is given. That file takes the name `path` when
    the block has succeeded, and is removed when it has not. It lies in the same folder
    under a secret name with the same suffix, from which writers tell the format. `size`
    is the number of bytes that will be written, as far as it is known. A `new` file
    takes no name that another one has, which is a FileExistsError.
    """
    path = Path(path)
    part = path.parent / f".{path.stem[:40]}.{token_hex(8)}.part{path.suffix}"
    _unfinished.add(part)
    try:
        require_space(path.parent, size)
        yield part
        _flush(part)
        if not new and path.exists():
            shutil.copymode(path, part)
        try:
            (os.link if new else os.replace)(part, path)
        except OSError as error:
            if not new or isinstance(error, FileExistsError):
                raise
            os.replace(part, path)  # on a disk that has no links
        _flush(path.parent)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        _remove(part)
        _unfinished.discard(part)


@contextmanager
def unfinished(*paths: Path) -> Iterator[None]:
    """Files and folders that are removed again unless the block succeeds."""
    _unfinished.update(paths)
    try:
        yield
    except BaseException:
        for path in paths:
            _remove(path)
        raise
    finally:
        _unfinished.difference_update(paths)


def remove_unfinished() -> None:
    """Remove the files that are being written, before a process ends at once."""
    for path in list(_unfinished):
        _remove(path)


def _remove(path: Path) -> None:
    shutil.rmtree(path, ignore_errors=True)  # a folder
    with suppress(OSError):
        path.unlink()


def require_space(folder: Path, size: int) -> None:
    """Refuse to write a number of bytes that a folder's disk has no room for."""
    total, _, free = shutil.disk_usage(folder)
    if total and free < size:  # some, as /proc, do not say what they have
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))


def placed(path: Path) -> Path:
    """The place of a file, which alone may be a link, through folders that are none."""
    return path.parent.resolve() / path.name


def open_file(path: Path | str) -> BufferedReader:
    """Open a file for reading, and nothing that would be waited for or never ends."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except ValueError:  # of a name with a zero byte
        raise OSError(errno.EINVAL, "not the name of a file", str(path)) from None
    kind = os.fstat(handle).st_mode
    if stat.S_ISREG(kind):
        return os.fdopen(handle, "rb")
    os.close(handle)
    if stat.S_ISDIR(kind):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    raise OSError(errno.EINVAL, "not a file", str(path))


def read_file(path: Path | str, largest: int = LARGEST_TEXT) -> bytes:
    """Contents of a file that somebody else may have made, of so many bytes at most."""
    with open_file(path) as file:
        content = file.read(largest + 1) or b""  # None of what would be waited for
    if len(content) > largest:
        raise OSError(errno.EFBIG, f"larger than {largest / 1e6:g} MB", str(path))
    return content


def read_text(path: Path | str, largest: int = LARGEST_TEXT) -> str:
    """Such a file's text, without a mark of UTF-8 before it; ValueError for others."""
    try:
        return read_file(path, largest).decode("utf-8-sig")  # spreadsheets mark it
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise ValueError(f"line {line} is no text in UTF-8, as it must be") from None


def _flush(path: Path) -> None:
    """Wait until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
