"""The film of a finished walk, drawn from its run folder alone.

Processes draw it in pieces, each with the driver chosen in MUJOCO_GL: crashes, leaks
and hanging drivers affect them alone and cause an error, and the run itself survives.
This module is also their program; it prints a dot for every picture.
"""

import errno
import os
import select
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from fcntl import LOCK_EX, LOCK_NB, LOCK_SH, flock
from glob import escape
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO

from models.description import silence_the_engine
from planner.support import unfinished
from sim.errors import RenderError, UsageError
from sim.folder import blamed_on, whole
from sim.pictures import file, gl
from sim.pictures.camera import Camera, camera, view_of
from sim.pictures.captions import Captions
from sim.pictures.clock import WHOLE, Clock, Stretch, clock, rows_of
from sim.pictures.marks import grid, marks
from sim.pictures.offscreen import LOOKS, OffscreenRenderer
from sim.runs.run import read_run

NAME = "video.mp4"
SILENCE = 120.0  # [s] without a new picture
SPARE = 2**20  # bytes; with less a disk is full
KEPT = "the run itself is kept"
Worker = tuple[subprocess.Popen[bytes], IO[bytes]]  # a process and its standard error


@dataclass(frozen=True)
class Piece:
    """Consecutive pictures of a film, and the file that receives them."""

    folder: Path  # of the run
    look: str
    frames: range
    path: Path
    shot: str = "across"  # name of the view, or its angles
    stretch: Stretch = WHOLE

    @property
    def command(self) -> list[str]:
        """How to start the process that draws it."""
        frames, shot = self.frames, (self.shot, *self.stretch)
        asked = self.folder, self.look, frames.start, frames.stop, self.path, *shot
        return [sys.executable, "-P", "-m", "sim.pictures.run_film", *map(str, asked)]


def check() -> str:
    """The OpenGL driver that can draw films, or RenderError, in half a second."""
    file.check_encoder()
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

    The look is `draft`, or `final` in the sun with smooth edges, several times slower.
    By default the film is the run's own `video.mp4`, or a name beside it that tells the
    stretch; a path that ends in `.webp` becomes a small animated picture. Progress is
    called with the finished part, from 0 to 1.
    """
    if look not in LOOKS:
        known = f"known are {', '.join(LOOKS)}"
        raise UsageError(f"unknown look {look!r}", "film", known)
    view_of(camera)
    folder = folder.absolute()
    with blamed_on(folder):
        walk = read_run(folder).in_world()
        _ = [walk.model.geom(foot) for foot in walk.card.feet]  # refused here in time
        first, last = walk.time[[*rows_of(walk.time, stretch)]]
        if first == last:
            end = f"{stretch[1]:g} s".replace("inf s", "the end")
            facts = {"start": max(stretch[0], 0), "end": end, "last": walk.time[-1]}
            raise UsageError.of("nothing_to_film", "film", **facts)
        pictures = len(clock(walk.time, walk.scenario.playback, stretch).rows)
    driver = check()
    drawn = 0

    def report(more: int) -> None:
        nonlocal drawn
        drawn += more
        if progress is not None:
            progress(drawn / pictures)

    own = NAME if stretch == WHOLE else f"video-{first:.2f}-{last:.2f}.mp4"
    new, path = path is not None, path.absolute() if path else folder / own
    with whole(path, new=new) as part, _scratch(path) as scratch:
        pieces = [
            Piece(folder, look, frames, scratch / f"{i}.mp4", camera, stretch)
            for i, frames in enumerate(_shares(pictures))
        ]
        draw(pieces, driver, report)
        small = path.suffix == ".webp"  # which is a small animated picture
        film = scratch / NAME if small else part
        file.join([piece.path for piece in pieces], film)
        if (found := file.count_pictures(film)) != pictures:
            raise RenderError.of("cut_short", path, found=found, pictures=pictures)
        if small:
            file.animate(film, part)
    return path


@contextmanager
def _scratch(film: Path) -> Iterator[Path]:
    """A hidden folder on the film's disk; those of films that were killed are removed.

    Every film holds a shared lock on its folder, which ends with the process.
    """
    with ExitStack() as stack:
        folder = os.open(film.parent, os.O_RDONLY)
        stack.callback(os.close, folder)
        with suppress(OSError):  # another film is drawn, or the disk has no locks
            flock(folder, LOCK_EX | LOCK_NB)
            for left in film.parent.glob(f".{escape(film.stem)}.*.pieces"):
                shutil.rmtree(left, ignore_errors=True)
        with suppress(OSError):
            flock(folder, LOCK_SH)
        place = TemporaryDirectory(".pieces", f".{film.stem}.", film.parent)
        scratch = Path(stack.enter_context(place))
        stack.enter_context(unfinished(scratch))
        yield scratch


def _shares(pictures: int) -> list[range]:
    """Equal shares of the pictures, one for each process."""
    cores = len(os.sched_getaffinity(0))
    workers = min(2, cores, 1 + pictures // 90)  # each takes 200 MB
    ends = [pictures * i // workers for i in range(workers + 1)]
    return [range(*share) for share in pairwise(ends)]


def draw(pieces: Sequence[Piece], driver: str, progress: Callable[[int], None]) -> None:
    """Draw pieces at the same time; progress is called with pictures just drawn.

    RenderError if a process fails, or if none draws anything for `SILENCE`.
    """
    threads = max(1, len(os.sched_getaffinity(0)) // len(pieces))
    environment = {**gl.environment(driver), "LP_NUM_THREADS": str(threads)}
    where = str(pieces[0].folder)
    with ExitStack() as stack:
        dots, pen = os.pipe()
        stack.callback(os.close, dots)
        workers = [_start(stack, piece, environment, pen) for piece in pieces]
        os.close(pen)
        while drawn := _wait(dots, where):
            progress(drawn)
            for worker in workers:
                if worker[0].poll():
                    _check(worker, pieces[0])
        for worker in workers:
            _check(worker, pieces[0])


def _start(stack: ExitStack, piece: Piece, env: dict[str, str], pen: int) -> Worker:
    complaints = stack.enter_context(TemporaryFile())  # noqa: SIM115 (it does)
    process = subprocess.Popen(
        piece.command, env=env, stdin=subprocess.DEVNULL, stdout=pen, stderr=complaints
    )
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process, complaints


def _check(worker: Worker, piece: Piece) -> None:
    """Raise OSError if the disk is full, RenderError for another failure."""
    process, complaints = worker
    if (code := process.wait()) == 0:
        return
    complaints.seek(0)
    message = complaints.read().decode(errors="replace")
    if file.FULL in message or shutil.disk_usage(piece.path.parent).free < SPARE:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    last = (message.strip().splitlines() or ["no word"])[-1]
    reason = f"signal {-code}" if code < 0 else last.removeprefix("OSError: ")
    raise RenderError(f"drawing the film failed, {reason}", str(piece.folder), KEPT)


def _wait(dots: int, where: str) -> int:
    """Number of pictures drawn since the last call; 0 when all processes have ended."""
    if not select.select([dots], [], [], SILENCE)[0]:
        raise RenderError(f"no picture for {SILENCE:g} s", where, KEPT)
    return len(os.read(dots, 4096))


def is_held(film_clock: Clock, view: Camera, frame: int) -> bool:
    """Whether a frame shows the same picture as the one before it."""
    if frame in (film_clock.scene.start, film_clock.scene.stop):
        return False
    rows = film_clock.rows
    return bool(rows[frame] == rows[frame - 1]) and view.rests(frame)


def _main() -> None:
    folder, look, start, stop, path, shot, begin, end = sys.argv[1:]
    silence_the_engine()  # a log would otherwise appear in the current folder
    frames, stretch = range(int(start), int(stop)), (float(begin), float(end))
    walk = read_run(Path(folder), inspected=True).in_world()
    film_clock = clock(walk.time, walk.scenario.playback, stretch)
    view = camera(walk, film_clock, view_of(shot))
    captions = Captions(walk, film_clock, view)
    drawn = (grid(view, walk.reach), *marks(walk, film_clock, frames))
    renderer = OffscreenRenderer(walk, drawn, view, LOOKS[look])
    with closing(renderer), file.encoding(Path(path)) as append:
        for frame in frames:
            if frame == frames[0] or not is_held(film_clock, view, frame):
                row = int(film_clock.rows[frame])
                picture = renderer.picture(frame, row)
                if frame in film_clock.scene:
                    captions.write(picture, row)
                else:
                    captions.lay_card(picture, frame)
            append(picture)
            os.write(sys.stdout.fileno(), b".")


if __name__ == "__main__":
    _main()
