"""Files that belong to a robot besides its MJCF: meshes, textures, height fields.

They are gathered from wherever the MJCF, its includes and its attached parts keep them,
so that a model that is written to another folder finds its own copies.
"""

from __future__ import annotations

from pathlib import Path

import mujoco

from models import ModelError, Robot
from models.description import elements_with_files

FOLDER = "assets"  # beside model.xml


def gather(spec: mujoco.MjSpec, robot: Robot) -> dict[str, bytes]:
    """Make a spec's files those of `assets/`, and return what belongs there.

    Args:
        spec: The robot's; its elements are given new file names.
        robot: Whose files.

    Returns:
        Content by path relative to model.xml; one entry a file, however often it is
        used.

    Raises:
        ModelError: If a file cannot be read.
    """
    named: dict[Path, str] = {}
    for element, folder, found in list(elements_with_files(spec, robot.model)):
        base = Path(spec.modelfiledir) / folder
        if element.file:
            element.file = _rename(named, found or base / element.file)
        if getattr(element, "cubefiles", None) is not None:
            for i, file in enumerate(element.cubefiles):
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
