"""The files that a robot is made of beside its MJCF: meshes, textures, height fields.

Gathers them from wherever the MJCF, its includes and its attached parts keep them, so
that a model written to another folder finds its own copies.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco

from models import ModelError, Robot

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
    for element, folder, found in list(_elements(spec, robot.model)):
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


def sources(robot: Robot) -> set[Path]:
    """Where a robot's files are."""
    spec = robot.read()
    paths = set()
    for element, folder, found in _elements(spec, robot.model):
        base = Path(spec.modelfiledir) / folder
        if element.file:
            paths.add(found or base / element.file)
        paths |= {base / file for file in getattr(element, "cubefiles", ()) if file}
    return paths


def _elements(
    spec: mujoco.MjSpec, model: mujoco.MjModel
) -> Iterator[tuple[Any, str, Path | None]]:
    """Elements that may have a file, their folder, and where the compiler found it."""
    for mesh in spec.meshes:
        yield mesh, mesh.compiler.meshdir, _found(model, "mesh", mesh.name)
    for field in spec.hfields:
        yield field, field.compiler.meshdir, _found(model, "hfield", field.name)
    for skin in spec.skins:
        yield skin, skin.compiler.meshdir, _found(model, "skin", skin.name)
    for texture in spec.textures:
        yield texture, texture.compiler.texturedir, _found(model, "tex", texture.name)


def _found(model: mujoco.MjModel, kind: str, name: str) -> Path | None:
    """The file that an element was compiled from; None if the compiler dropped it."""
    places = getattr(model, f"{kind}_pathadr")
    for i, place in enumerate(places):
        if place >= 0 and getattr(model, kind)(i).name == name:
            return Path(model.paths[place:].split(b"\0", 1)[0].decode())
    return None


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
