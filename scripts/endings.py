"""Run something in a process and a folder of its own, and end all of it in time."""

import faulthandler
import math
import multiprocessing
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, NoReturn

ROOT = Path(__file__).resolve().parents[1]
PROGRESS = re.compile(r"[^:]+, (about \d+ s left|\d+ s so far)")  # of long work
HINTS = tuple(f"stratawalk: {kind}: " for kind in ("notice", "warning", "driven"))
SLICE = 0.5  # [s] of waiting; a stop of all processes counts as one
FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True)
class Ending:
    """How a process ended."""

    code: int | None  # None if it did not end in time
    printed: str
    warned: list[str]  # lines on standard error, but for those about progress

    @property
    def wrong(self) -> str | None:
        """What is wrong with the exit code and the lines of a command, or None."""
        lines = [line for line in self.warned if not line.startswith(HINTS)]
        said = " ".join(lines)[:300]
        if self.code is None:
            return "does not end in time"
        if self.code not in {0, 2, 3, 4, 6, 7, 8}:  # that an input alone may lead to
            return f"ends with {self.code}: {said}"
        if len(lines) != (self.code != 0):
            return f"says {len(lines)} lines with code {self.code}: {said}"
        return None


@dataclass(frozen=True)
class Bounds:
    """What a process and those that it starts may take."""

    seconds: float = 10.0  # on the processor, each
    memory: int = 2 * 10**9  # bytes
    patience: float = 60.0  # until all of them have ended

    def hold(self) -> None:
        """Let this process take no more from now on."""
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(self.seconds), most))
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (self.memory, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def ending(act: Callable[[], int], folder: str | Path, seconds: float) -> Ending:
    """How a process that is forked and calls `act` ends, in so many seconds."""
    with tempfile.TemporaryFile() as printed, tempfile.TemporaryFile() as warned:
        files = printed, warned
        process = FORK.Process(target=_begun, args=(act, folder, files))
        process.start()
        try:
            for _ in range(math.ceil(seconds / SLICE)):
                process.join(SLICE)
                if process.exitcode is not None:
                    break
            code = process.exitcode
        finally:
            with suppress(ProcessLookupError):  # of what it left in the background
                os.killpg(process.pid or 0, signal.SIGKILL)
            process.kill()
            process.join()
        for file in files:
            file.seek(0)
        out, err = (file.read().decode(errors="replace") for file in files)
        said = [line for line in err.splitlines() if not PROGRESS.match(line)]
        return Ending(code, out, said)


def _begun(
    act: Callable[[], int], folder: str | Path, files: Sequence[IO[bytes]]
) -> NoReturn:
    faulthandler.disable()  # a crash is an ending like others
    os.setsid()
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for number, file in enumerate(files, start=1):
        os.dup2(file.fileno(), number)
    sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
    warnings.simplefilter("ignore")  # as the command does
    code = act()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)  # whichever thread this was forked from


def other(words: Sequence[str], env: Mapping[str, str]) -> int:
    """Run another program, and end as it does."""
    code = subprocess.call(words, env=env)
    if code < 0:
        os.kill(os.getpid(), -code)
    return code
