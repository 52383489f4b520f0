"""A separate process that draws and encodes some pictures of a film.

`pictures.crew` starts it with the driver chosen in MUJOCO_GL, so that crashes, leaks
and hanging drivers affect this process alone. It prints a dot for every picture.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import mujoco

from sim.pictures.camera import camera
from sim.pictures.captions import Captions
from sim.pictures.clock import clock
from sim.pictures.file import encoding
from sim.pictures.marks import marks
from sim.pictures.stage import Stage
from sim.pictures.story import read_walk
from sim.pictures.style import LOOKS


def draw(folder: Path, look: str, frames: range, piece: Path) -> None:
    """Draw frames of the film of a run folder.

    Args:
        folder: Of a finished run.
        look: Name of the look.
        frames: Which ones.
        piece: File to encode them to.
    """
    walk = read_walk(folder)
    film_clock = clock(walk.time, walk.scenario.playback)
    captions = Captions(walk, film_clock)
    drawn = marks(walk, film_clock, frames)
    with (
        Stage(walk, drawn, camera(walk, film_clock), LOOKS[look]) as stage,
        encoding(piece) as writer,
    ):
        for frame in frames:
            row = int(film_clock.rows[frame])
            picture = stage.picture(frame, row)
            captions.write(picture, row)
            writer.append_data(picture)
            os.write(sys.stdout.fileno(), b".")


def main() -> None:
    """Read the command line that `pictures.direction` composes."""
    folder, look, start, stop, piece = sys.argv[1:]
    log = mujoco.MjLogConfig.get()
    log.logto_file = False  # it would otherwise appear in the current folder
    log.set()
    draw(Path(folder), look, range(int(start), int(stop)), Path(piece))


if __name__ == "__main__":
    main()
