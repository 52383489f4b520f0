"""One process at a time works on a sweep's folder.

The system lets go of a lock when its owner ends, however it ends; the lock of a process
that is gone is therefore never in the way. Who holds it stands beside it.
"""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from sim.errors import FilesError


@contextmanager
def sole_owner(path: Path) -> Iterator[str | None]:
    """Hold a lock while the block runs.

    Args:
        path: File of the lock, in a folder that exists.

    Yields:
        Who held the lock last and ended without letting go, if anybody did.

    Raises:
        FilesError: If another process holds it, saying which.
    """
    lock, owner = FileLock(path, timeout=0), path.with_suffix(".owner")
    try:
        lock.acquire()
    except Timeout:
        raise FilesError(
            f"{_read(owner) or 'another process'} is working on this sweep",
            str(path.parent),
            "wait for it, or choose another folder with --out",
        ) from None
    except OSError as error:
        reason = f"cannot be locked, {error.strerror}"
        raise FilesError(reason, str(path.parent), "choose another folder") from error
    try:
        gone = _read(owner)
        owner.write_text(json.dumps({"pid": os.getpid(), "host": socket.gethostname()}))
        yield gone
        owner.unlink(missing_ok=True)
    finally:
        lock.release()


def _read(owner: Path) -> str | None:
    """Who stands in the file, in words."""
    try:
        told = json.loads(owner.read_text())
        return f"process {told['pid']} on {told['host']}"
    except (OSError, ValueError, KeyError, TypeError):
        return None
