"""Run a command in a folder of its own, and look how it ends.

A command that does not end in time is killed with all that it started.
"""

from __future__ import annotations

import math
import os
import re
import resource
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CODES = {0, 2, 3, 4, 6, 7, 8}  # that an input alone may lead to
PROGRESS = re.compile(r"[^:]+, (about \d+ s left|\d+ s so far)")  # of long work
SLICE = 0.5  # [s] of waiting; a stop of all processes counts as one


@dataclass(frozen=True)
class Ending:
    """How a command ended."""

    code: int | None  # None if it did not end in time
    printed: str
    warned: list[str]  # lines on standard error, but for those about progress


def ending(
    words: Sequence[str],
    folder: str | Path,
    seconds: float,
    env: Mapping[str, str],
    begin: Callable[[], object] | None = None,
) -> Ending:
    """Run a command in a folder and wait for its end, for so many seconds at most.

    `begin` is called in the new process before the program begins.
    """
    with tempfile.TemporaryFile() as printed, tempfile.TemporaryFile() as warned:
        process = subprocess.Popen(
            words,
            cwd=folder,
            env=env,
            stdin=subprocess.DEVNULL,
            stdout=printed,
            stderr=warned,
            start_new_session=True,
            preexec_fn=begin,
        )
        code = None
        try:
            for _ in range(math.ceil(seconds / SLICE)):
                with suppress(subprocess.TimeoutExpired):
                    code = process.wait(SLICE)
                    break
        finally:
            end_session(process.pid)  # with what it left in the background
            process.wait()
        for file in (printed, warned):
            file.seek(0)
        out, err = (f.read().decode(errors="replace") for f in (printed, warned))
        return Ending(code, out, lines_of(err))


def end_session(leader: int | None) -> None:
    """End all processes of a session, if it has begun and there are any left."""
    with suppress(ProcessLookupError):
        if leader:
            os.killpg(leader, signal.SIGKILL)


@dataclass(frozen=True)
class Bounds:
    """What a case may take."""

    seconds: float = 60.0  # on the processor
    memory: int = 6 * 10**9  # bytes; a model of 4 GB beside the libraries


def limit_process(bounds: Bounds) -> None:
    """Let this process and those that it starts take no more than that from now on."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    end = math.ceil(used.ru_utime + used.ru_stime + bounds.seconds) + 1
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (end, most))
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (bounds.memory, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def lines_of(text: str) -> list[str]:
    """Lines on standard error, but for those about the progress of long work."""
    return [line for line in text.splitlines() if not PROGRESS.match(line)]


def judged(code: int, warned: Sequence[str]) -> str | None:
    """What is wrong with an exit code and the lines on standard error, or None."""
    if code not in CODES:
        return f"ends with {code}: {' '.join(warned)[:300]}"
    if len(warned) > 1 or (len(warned) == 1) != (code != 0):
        return f"says {len(warned)} lines with code {code}: {warned[:2]}"
    return None
