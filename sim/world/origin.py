"""Copies of the robot's files: its MJCF, its card and all included files, unchanged.

A run folder keeps them beside model.xml, whose numbers MuJoCo rounds. A rerun from the
copies is planned with the same digits, wherever the folder has been moved.
"""

from __future__ import annotations

import os
from pathlib import Path

from models import Robot

COPY = "robot"  # folder in the run folder


def origin(robot: Robot) -> tuple[str, dict[str, bytes]]:
    """Name or path of the robot in a run folder, and the files that it needs.

    A shipped robot is referred to by its name and needs no files.

    Returns:
        Name of a shipped robot, or path of its MJCF relative to the run folder; content
        by path relative to the run folder.
    """
    if robot.is_shipped:
        return robot.name, {}
    mjcf = robot.path.resolve()
    used = {path.resolve() for path in (mjcf, *robot.files)}
    above = os.path.commonpath([path.parent for path in used])
    copies = {
        Path(COPY, path.relative_to(above)).as_posix(): path.read_bytes()
        for path in sorted(used)
    }
    main = Path(COPY, mjcf.relative_to(above))
    if not robot.has_card_inside:
        copies[main.with_suffix(".toml").as_posix()] = robot.card_text.encode()
    return main.as_posix(), copies
