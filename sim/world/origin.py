"""The robot as it was given: its MJCF, its card and all they include, byte for byte.

A run folder keeps this beside model.xml, whose numbers MuJoCo rounds: what is run again
from the copy is planned with the same digits, wherever the folder has gone.
"""

from __future__ import annotations

import os
from pathlib import Path

from models import FOLDER, Robot, has_card_inside

COPY = "robot"  # folder in the run folder


def origin(robot: Robot) -> tuple[str, dict[str, bytes]]:
    """What names the robot in a run folder, and the files that takes.

    A shipped robot goes by its name, and takes none.

    Returns:
        Name of a shipped robot, or path of its MJCF relative to the run folder; content
        by path relative to the run folder.
    """
    if robot.path.parent == FOLDER:
        return robot.name, {}
    mjcf = robot.path.resolve()
    used = {path.resolve() for path in (mjcf, *robot.files)}
    above = os.path.commonpath([path.parent for path in used])
    copies = {
        Path(COPY, path.relative_to(above)).as_posix(): path.read_bytes()
        for path in sorted(used)
    }
    main = Path(COPY, mjcf.relative_to(above))
    if not has_card_inside(robot.path):
        copies[main.with_suffix(".toml").as_posix()] = robot.card_text.encode()
    return main.as_posix(), copies
