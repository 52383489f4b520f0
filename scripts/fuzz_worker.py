"""How the command ends: in the process that runs one case of the fuzz after another.

Nothing that a case does reaches further than this process: its memory and the time it
computes are limited, and `scripts/fuzz.py` ends it where it does not answer. Models
are compiled here and not by a process of their own, so that a case takes some
hundredths of a second.
"""

from __future__ import annotations

import contextlib
import functools
import io
import math
import os
import re
import resource
import sys
import tempfile
import warnings
from collections.abc import Iterator
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path

from models import ModelError

CODES = {0, 2, 3, 4, 6}
PROGRESS = re.compile(r"[^:]+, (about \d+ s left|\d+ s so far)")  # of long work
MEMORY = 6 * 10**9  # bytes; a model of 4 GB beside the libraries


def serve(cases: Connection, limit: float) -> None:
    """Answer words of the command, and the folder to run it in, with what is wrong.

    Args:
        cases: Gives the pairs and takes the answers, until its other end closes.
        limit: Seconds of computing after which the system ends this process.
    """
    os.setsid()
    quicken()
    cases.send("ready")
    with tempfile.TemporaryFile() as below, contextlib.suppress(EOFError):
        for stream in (sys.stdout, sys.stderr):
            os.dup2(below.fileno(), stream.fileno())
        while True:
            folder, words = cases.recv()
            limit_process(limit)
            os.chdir(folder)
            begin = below.seek(0, io.SEEK_END)
            wrong = fault(words)
            below.seek(begin)
            lines = below.read().decode(errors="replace").splitlines()
            cases.send(wrong or _judged_below(lines))
            os.chdir("/")


def limit_process(seconds: float) -> None:
    """Let this process and those that it starts have so much memory and time.

    Args:
        seconds: More of computing than before; then the system ends the process.
    """
    used = resource.getrusage(resource.RUSAGE_SELF)
    end = math.ceil(used.ru_utime + used.ru_stime + seconds) + 1
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (end, most))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def quicken() -> None:
    """Try models in this process, and make the parser of the command line once.

    No door leads to the parts that are replaced.
    """
    cli = import_module("sim.cli")
    cli.parser = functools.cache(cli.parser)  # type: ignore[attr-defined]
    inspection = import_module("models.description.inspection")
    trial = import_module("models.description.trial")

    def tried(path: Path) -> list[str]:
        report = trial.report(path)
        if "files" not in report:
            raise ModelError(str(report.get("wrong", "too large")))
        return list(report["files"])

    inspection._tried = tried  # type: ignore[attr-defined]


def fault(words: list[str]) -> str | None:
    """What is wrong with how the command ends in this process, or None."""
    said = io.StringIO()
    try:
        with _heard(said):
            code = import_module("sim.cli").main(words)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return f"raises {type(error).__name__}: {error}"
    return judged(code, said.getvalue())


@contextlib.contextmanager
def _heard(said: io.StringIO) -> Iterator[None]:
    with (
        contextlib.redirect_stderr(said),
        contextlib.redirect_stdout(io.StringIO()),
        warnings.catch_warnings(action="ignore"),  # as the command does
    ):
        yield


def judged(code: int, said: str) -> str | None:
    """What is wrong with an exit code and what stands on standard error, or None."""
    lines = [line for line in said.splitlines() if not PROGRESS.match(line)]
    if code not in CODES:
        return f"ends with {code}: {' '.join(lines)[:300]}"
    if len(lines) > 1 or (len(lines) == 1) != (code != 0):
        return f"says {len(lines)} lines with code {code}: {lines[:2]}"
    return None


def _judged_below(lines: list[str]) -> str | None:
    return f"a library says: {lines[:2]}" if lines else None
