"""The film of a finished walk, drawn from its run folder alone."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

from sim.errors import RenderError, UsageError
from sim.folder import blamed_on, whole
from sim.pictures import gl
from sim.pictures.camera import view_of
from sim.pictures.clock import WHOLE, Stretch, clock, rows_of
from sim.pictures.file import animate, check_encoder, count_pictures, join
from sim.pictures.processes import KEPT, Piece, draw
from sim.pictures.scene import LOOKS
from sim.runs.run import read_run

NAME = "video.mp4"
ANIMATED = ".webp"  # of files that are small animated pictures instead
WORKERS = 2  # processes at most; each takes 200 MB
FEWEST_PICTURES = 90  # pictures that are worth a process


def check() -> str:
    """The OpenGL driver that can draw films, or RenderError, in half a second."""
    check_encoder()
    return gl.probe()


def film_folder(
    folder: Path,
    *,
    look: str = "draft",
    camera: str = "across",
    stretch: Stretch = WHOLE,
    path: Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Film a run folder or a stretch of it [s]; the film's path.

    The look is `draft`, or `final` with shadows and smooth edges, several times slower.
    By default the film is the run's own `video.mp4`, or a name beside it that tells the
    stretch; a path that ends in `.webp` becomes a small animated picture. Progress is
    called with the finished part, from 0 to 1.
    """
    if look not in LOOKS:
        known = f"known are {', '.join(LOOKS)}"
        raise UsageError(f"unknown look {look!r}", "film", known)
    view_of(camera)
    folder = folder.resolve()
    with blamed_on(folder):
        walk = read_run(folder).in_world()
        _ = walk.model  # which is refused here, and not by the processes that draw
        first, last = walk.time[[*rows_of(walk.time, stretch)]]
        if first == last:
            what = "nothing to film between {:g} and {:g} s".format(*stretch)
            remedy = f"give times from 0 to {walk.time[-1]:.2f} s"
            raise UsageError(what, "film", remedy)
        pictures = len(clock(walk.time, walk.scenario.playback, stretch).rows)
    driver = check()
    drawn = 0

    def report(more: int) -> None:
        nonlocal drawn
        drawn += more
        if progress is not None:
            progress(drawn / pictures)

    own = NAME if stretch == WHOLE else f"video-{first:.2f}-{last:.2f}.mp4"
    path = path.absolute() if path else folder / own
    with whole(path) as part, _scratch(path) as scratch:
        pieces = [
            Piece(folder, look, frames, scratch / f"{i}.mp4", camera, stretch)
            for i, frames in enumerate(_shares(pictures))
        ]
        draw(pieces, driver, report)
        small = path.suffix == ANIMATED
        film = scratch / NAME if small else part
        join([piece.path for piece in pieces], film)
        if (found := count_pictures(film)) != pictures:
            what = f"film cut short, {found} of {pictures} pictures"
            raise RenderError(what, str(path), KEPT)
        if small:
            animate(film, part)
    return path


@contextmanager
def _scratch(film: Path) -> Iterator[Path]:
    """A hidden folder on the film's disk; remains of an earlier film are removed."""
    scratch = film.parent / f".{film.stem}.pieces"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    try:
        yield scratch
    finally:
        shutil.rmtree(scratch)


def _shares(pictures: int) -> list[range]:
    """Equal shares of the pictures, one for each process."""
    cores = len(os.sched_getaffinity(0))
    workers = min(WORKERS, cores, 1 + pictures // FEWEST_PICTURES)
    ends = [pictures * i // workers for i in range(workers + 1)]
    return [range(*share) for share in pairwise(ends)]
