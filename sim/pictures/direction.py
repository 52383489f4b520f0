"""The film of a finished walk, drawn from its run folder alone.

This module finds a driver, starts the processes that draw, and gives the film its name
once it is complete. The other modules of this room decide what the pictures show.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sim.errors import RenderError, UsageError
from sim.folder import whole
from sim.pictures import gl
from sim.pictures.clock import clock
from sim.pictures.crew import KEPT, Piece, draw
from sim.pictures.file import check_encoder, count_pictures, join
from sim.pictures.story import read_walk
from sim.pictures.style import LOOKS

NAME = "video.mp4"
WORKERS = 2  # processes at most; each takes 200 MB
SHORTEST = 90  # pictures that are worth a process


def check() -> str:
    """Test in half a second whether films can be made on this machine.

    Returns:
        Name of the OpenGL driver that will draw.

    Raises:
        RenderError: If no driver draws, or pictures cannot be encoded.
    """
    check_encoder()
    return gl.probe()


def film_folder(
    folder: Path,
    *,
    look: str = "draft",
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Film a run.

    Args:
        folder: Run folder; it receives `video.mp4`.
        look: `draft`, or `final` with shadows and smooth edges, four times slower.
        progress: Called with the finished part, from 0 to 1.

    Returns:
        The film's path.

    Raises:
        UsageError: If the folder holds no finished run, or there is no such look.
        RenderError: If pictures cannot be drawn or encoded.
        FilesError: If the film cannot be written.
    """
    if look not in LOOKS:
        raise UsageError(
            f"unknown look {look!r}", "film", f"known are {', '.join(LOOKS)}"
        )
    folder, driver = folder.resolve(), check()
    walk = read_walk(folder)
    pictures = len(clock(walk.time, walk.scenario.playback).rows)
    drawn = 0

    def report(more: int) -> None:
        nonlocal drawn
        drawn += more
        if progress is not None:
            progress(drawn / pictures)

    path = folder / NAME
    with whole(path) as part, _scratch(folder) as scratch:
        pieces = [
            Piece(folder, look, frames, scratch / f"{i}.mp4")
            for i, frames in enumerate(_shares(pictures))
        ]
        draw(pieces, driver, report)
        join([piece.path for piece in pieces], part)
        if (found := count_pictures(part)) != pictures:
            raise RenderError(
                f"film cut short, {found} of {pictures} pictures", str(path), KEPT
            )
    return path


@contextmanager
def _scratch(folder: Path) -> Iterator[Path]:
    """A hidden folder on the film's disk; remains of an earlier film are removed."""
    scratch = folder / ".video.pieces"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    try:
        yield scratch
    finally:
        shutil.rmtree(scratch)


def _shares(pictures: int) -> list[range]:
    """Equal shares of the pictures, one for each process."""
    workers = min(WORKERS, len(os.sched_getaffinity(0)), 1 + pictures // SHORTEST)
    ends = [pictures * i // workers for i in range(workers + 1)]
    return [range(start, stop) for start, stop in zip(ends[:-1], ends[1:], strict=True)]
