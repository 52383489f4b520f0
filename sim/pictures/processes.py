"""Processes that draw the pieces of a film, supervised until all have finished.

Each process has a driver of its own; one that crashes or hangs causes an error, and the
run itself survives.
"""

from __future__ import annotations

import os
import select
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from sim.errors import FilesError, RenderError
from sim.pictures import gl
from sim.pictures.clock import WHOLE, Stretch
from sim.pictures.file import FULL

SILENCE = 120.0  # [s] without a new picture
SPARE = 2**20  # bytes; with less a disk is full
KEPT = "the run itself is kept"


@dataclass(frozen=True)
class Piece:
    """Consecutive pictures of a film, and the file that receives them."""

    folder: Path  # of the run
    look: str
    frames: range
    path: Path
    camera: str = "across"
    stretch: Stretch = WHOLE

    @property
    def command(self) -> list[str]:
        """How to start the process that draws it."""
        frames = (str(self.frames.start), str(self.frames.stop))
        shot = (self.camera, *map(str, self.stretch))
        arguments = [str(self.folder), self.look, *frames, str(self.path), *shot]
        return [sys.executable, "-P", "-m", "sim.pictures.worker", *arguments]


def draw(pieces: Sequence[Piece], driver: str, progress: Callable[[int], None]) -> None:
    """Draw pieces at the same time; progress is called with pictures just drawn.

    RenderError if a process fails, or if none draws anything for `SILENCE`.
    """
    threads = max(1, len(os.sched_getaffinity(0)) // len(pieces))
    environment = {**gl.environment(driver), "LP_NUM_THREADS": str(threads)}
    with ExitStack() as stack:
        dots, pen = os.pipe()
        stack.callback(os.close, dots)
        workers = [_start(stack, piece, environment, pen) for piece in pieces]
        os.close(pen)
        where = str(pieces[0].folder)
        while drawn := _wait(dots, where):
            progress(drawn)
            for process, complaints in workers:
                if process.poll():
                    _check(process, complaints, where)
        for process, complaints in workers:
            _check(process, complaints, where)


def _start(
    stack: ExitStack, piece: Piece, environment: dict[str, str], pen: int
) -> tuple[subprocess.Popen[bytes], IO[bytes]]:
    """A process at work on a piece, and its standard error."""
    complaints = stack.enter_context(tempfile.TemporaryFile())  # noqa: SIM115 (it does)
    process = subprocess.Popen(
        piece.command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=pen,
        stderr=complaints,
    )
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process, complaints


def _check(process: subprocess.Popen[bytes], complaints: IO[bytes], where: str) -> None:
    """Raise FilesError if the disk is full, RenderError for another failure."""
    if (code := process.wait()) == 0:
        return
    complaints.seek(0)
    message = complaints.read().decode(errors="replace")
    if FULL in message or shutil.disk_usage(where).free < SPARE:
        what, remedy = "disk full while filming", f"free some space; {KEPT}"
        raise FilesError(what, where, remedy)
    last = (message.strip().splitlines() or ["no word"])[-1]
    reason = f"signal {-code}" if code < 0 else last.removeprefix("OSError: ")
    raise RenderError(f"drawing the film failed, {reason}", where, KEPT)


def _wait(dots: int, where: str) -> int:
    """Number of pictures drawn since the last call; 0 when all processes have ended."""
    if not select.select([dots], [], [], SILENCE)[0]:
        raise RenderError(f"no picture for {SILENCE:g} s", where, KEPT)
    return len(os.read(dots, 4096))
