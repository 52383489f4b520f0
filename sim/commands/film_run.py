"""`stratawalk film`: the film of a finished run, made now or made again."""

from __future__ import annotations

import argparse
import math
import os
from pathlib import Path

from sim.commands.options import LOOK, RUN, option, report, run_of
from sim.errors import UsageError

HELP = "film a finished run, or a stretch of it, from any side"
SUFFIXES = (".mp4", ".webp")
CAMERAS = "across, follow, top, front, back, left, right or AZIMUTH,ELEVATION [degrees]"
OPTIONS = (
    RUN,
    option("--camera", default="across", metavar="VIEW", help=CAMERAS),
    option(
        "--from", dest="start", type=float, metavar="S", help="begin [s]; or the start"
    ),
    option("--to", dest="stop", type=float, metavar="S", help="end [s]; or the end"),
    LOOK,
    option(
        "--out",
        metavar="FILE",
        help="film to make in .mp4, or small animated picture in .webp; otherwise "
        "video.mp4 of the run, which it replaces, or for a stretch of time a name "
        "beside it",
    ),
)


def execute(options: argparse.Namespace) -> None:
    """Film the run and print the film's path."""
    path = _target(options.out)
    start = -math.inf if options.start is None else options.start
    stop = math.inf if options.stop is None else options.stop

    from sim.pictures.run_film import film_folder
    from sim.progress import bar

    with bar(quiet=options.json) as progress:
        film = film_folder(
            run_of(options),
            look=options.look,
            camera=options.camera,
            stretch=(start, stop),
            path=path,
            progress=lambda part: progress("filming", part),
        )
    report(options, {"film": str(film)}, film)


def _target(out: str | None) -> Path | None:
    """The film that `--out` names, which must be new."""
    from sim.folder import ensure_folder

    if out is None:
        return None
    path = Path(out)
    if path.suffix not in SUFFIXES:
        remedy = f"give a name in {' or '.join(SUFFIXES)}"
        raise UsageError("not a film's name", f"--out {out}", remedy)
    if os.path.lexists(path):
        raise UsageError("already exists", f"--out {out}", "give another name")
    ensure_folder(path.parent, "film's folder")
    return path
