"""A separate process that draws and encodes some pictures of a film.

`pictures.run_film` starts it with the driver chosen in MUJOCO_GL, so that crashes,
leaks and hanging drivers affect this process alone. It prints a dot for every picture.
"""

from __future__ import annotations

import os
import sys
from contextlib import closing
from pathlib import Path

import mujoco

from sim.pictures.camera import Camera, camera, view_of
from sim.pictures.captions import Captions
from sim.pictures.clock import Clock, clock
from sim.pictures.file import encoding
from sim.pictures.marks import grid, marks
from sim.pictures.offscreen import LOOKS, OffscreenRenderer
from sim.pictures.run_film import Piece
from sim.runs.run import read_run


def draw(piece: Piece) -> None:
    """Draw frames of the film of a run folder."""
    walk = read_run(piece.folder, inspected=True).in_world()
    frames = piece.frames
    film_clock = clock(walk.time, walk.scenario.playback, piece.stretch)
    view = camera(walk, film_clock, view_of(piece.camera))
    captions = Captions(walk, film_clock, view)
    drawn = (grid(view, walk.reach), *marks(walk, film_clock, frames))
    renderer = OffscreenRenderer(walk, drawn, view, LOOKS[piece.look])
    with closing(renderer), encoding(piece.path) as append:
        for frame in frames:
            if frame == frames[0] or not is_held(film_clock, view, frame):
                picture = captions.card(frame)
                if frame in film_clock.scene:
                    row = int(film_clock.rows[frame])
                    picture = renderer.picture(frame, row)
                    captions.write(picture, row)
            append(picture)
            os.write(sys.stdout.fileno(), b".")


def is_held(film_clock: Clock, view: Camera, frame: int) -> bool:
    """Whether a frame shows the same picture as the one before it."""
    if frame in (film_clock.scene.start, film_clock.scene.stop):
        return False
    rows = film_clock.rows
    return bool(rows[frame] == rows[frame - 1]) and view.rests(frame)


def main() -> None:
    """Read the command line that a `Piece` composes."""
    folder, look, start, stop, path, view, begin, end = sys.argv[1:]
    log = mujoco.MjLogConfig.get()
    log.logto_file = False  # it would otherwise appear in the current folder
    log.set()
    frames, stretch = range(int(start), int(stop)), (float(begin), float(end))
    draw(Piece(Path(folder), look, frames, Path(path), view, stretch))


if __name__ == "__main__":
    main()
