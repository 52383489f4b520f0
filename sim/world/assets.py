"""Files that belong to a robot: its MJCF and card, meshes, textures, height fields.

What model.xml names is gathered from wherever the MJCF, its includes and its attached
parts keep it. The robot's own files are copied unchanged beside model.xml, whose
numbers MuJoCo rounds: a rerun from the copies is planned with the same digits.
"""

from __future__ import annotations

import os
from pathlib import Path

import mujoco

from models import ModelError, Robot
from models.description import elements_with_files

FOLDER = "assets"  # beside model.xml
COPY = "robot"  # folder in the run folder, of the robot's own files


def gather(spec: mujoco.MjSpec, robot: Robot) -> dict[str, bytes]:
    """Make a spec's files those of `assets/`, and return their content.

    It is sorted by path relative to model.xml, with one entry a file, however often the
    file is used.
    """
    named: dict[Path, str] = {}
    for element, folder, found in list(elements_with_files(spec, robot.model)):
        base = Path(spec.modelfiledir) / folder
        if element.file:
            element.file = _rename(named, found or base / element.file)
        for i, file in enumerate(getattr(element, "cubefiles", ())):
            if file:
                element.cubefiles[i] = _rename(named, base / file)
        element.compiler.meshdir = element.compiler.texturedir = ""
    spec.compiler.meshdir = spec.compiler.texturedir = ""
    spec.strippath = False
    content = {name: _read(path, robot) for path, name in named.items()}
    spec.assets = content
    return content


def _rename(named: dict[Path, str], path: Path) -> str:
    """Name of a file in `FOLDER`, its own unless another one has it already."""
    if path not in named:
        name, number = path.name, 1
        while f"{FOLDER}/{name}" in named.values():
            number += 1
            name = f"{path.stem}-{number}{path.suffix}"
        named[path] = f"{FOLDER}/{name}"
    return named[path]


def _read(path: Path, robot: Robot) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise ModelError(
            f"an asset cannot be read, {error.strerror}: {path}, which {robot.path} "
            "uses; put it there, or correct meshdir or texturedir"
        ) from error


def origin(robot: Robot) -> tuple[str, dict[str, bytes]]:
    """Name or path of the robot in a run folder, and the files that it needs.

    A shipped robot is referred to by its name and needs none. Paths are relative to the
    run folder.
    """
    if robot.is_shipped:
        return robot.name, {}
    mjcf = robot.path.resolve()
    used = {path.resolve() for path in (mjcf, *robot.opened.files)}
    above = os.path.commonpath([path.parent for path in used])
    copies = {
        Path(COPY, path.relative_to(above)).as_posix(): path.read_bytes()
        for path in sorted(used)
    }
    main = Path(COPY, mjcf.relative_to(above))
    if not robot.has_card_inside:
        copies[main.with_suffix(".toml").as_posix()] = robot.card_text.encode()
    return main.as_posix(), copies
