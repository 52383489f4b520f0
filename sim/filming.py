"""Films of walks that have no run folder."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.errors import UsageError
from sim.evaluation.assessment import Evaluation, evaluate
from sim.pictures.run_film import film_folder
from sim.progress import Progress, silent
from sim.run_folder import write_numbers
from sim.simulation import Simulation
from sim.walking.finished import Walk


def film(
    walked: Walk | Evaluation | Simulation,
    path: str | Path,
    *,
    look: str = "draft",
    progress: Progress = silent,
) -> Path:
    """Film a walk.

    Args:
        walked: What to film.
        path: The film's file, which must not exist and ends in `.mp4`.
        look: `draft`, or `final` with shadows and smooth edges, several times slower.
        progress: Called with each stage and the finished part of it.

    Returns:
        The film's path.

    Raises:
        UsageError: If there is such a file already, it is no `.mp4`, or there is no
            such look.
        RenderError: If pictures cannot be drawn or encoded.
        FilesError: If the film cannot be written.
    """
    path = Path(path)
    if path.suffix != ".mp4":
        raise UsageError("not a film's name", str(path), "give a name in .mp4")
    if os.path.lexists(path):
        raise UsageError("already exists", str(path), "give another name")
    done = evaluate(walked) if isinstance(walked, Walk) else walked
    with TemporaryDirectory() as scratch:
        folder = write_numbers(done, Path(scratch) / "run").folder
        made = film_folder(
            folder.path, look=look, progress=lambda part: progress("filming", part)
        )
        shutil.move(made, path)
    return path
