"""The files that a model opens, and those of them outside its own folder.

Its own folder is the one that contains its MJCF. A model from elsewhere may name any
file of this machine as a mesh or texture, and a run copies the files of its model.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco

from models.errors import ModelError

NAMED = re.compile(r"""\bfile\w*\s*=\s*["']([^"']{1,200})["']""")
LONGEST_TEXT = 10**7  # bytes that are searched for names of files


@dataclass(frozen=True, slots=True)
class Opened:
    """The files that make a model."""

    files: tuple[Path, ...]  # all of them, the MJCF included
    external: tuple[Path, ...]  # those outside its own folder


def included(path: Path) -> list[Path]:
    """An MJCF file and the files that it includes or attaches, and may be more.

    Raises:
        ModelError: If it cannot be read, or names what is not a file.
    """
    _refuse_pipes(path, set())
    try:
        named = mujoco.mju_getXMLDependencies(str(path))
    except mujoco.FatalError as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"not a usable MJCF file: {path}; {reason}") from error
    for other in map(Path, named):
        if other.exists() and not other.is_file():  # a pipe would be waited for
            raise ModelError(f"not a file: {other}, which {path} names; correct it")
    return [Path(name) for name in named if Path(name).is_file()]


def _refuse_pipes(path: Path, seen: set[Path]) -> None:
    """Refuse what a file, and those that it names, would be waited for.

    Names that are spelt otherwise are not found here, and waited for until time is up.
    """
    seen.add(path)
    if not path.exists() or path.stat().st_size > LONGEST_TEXT:
        return
    for name in NAMED.findall(path.read_text(errors="replace")):
        other = path.parent / name
        if other in seen or "\0" in name or not other.exists():
            continue
        if not (other.is_file() or other.is_dir()):
            raise ModelError(f"not a file: {other}, which {path} names; correct it")
        if other.is_file():
            _refuse_pipes(other, seen)


def elements_with_files(
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


def assets(spec: mujoco.MjSpec, model: mujoco.MjModel) -> set[Path]:
    """Meshes, height fields, skins and textures of a model, used or not."""
    paths = set()
    for element, folder, found in elements_with_files(spec, model):
        base = Path(spec.modelfiledir) / folder
        if element.file:
            paths.add(found or base / element.file)
        paths |= {base / file for file in getattr(element, "cubefiles", ()) if file}
    return paths


def outside(paths: set[Path], folder: Path) -> list[Path]:
    """Those of some files that are not in a folder, links followed; in order."""
    own, found = folder.resolve(), {path.resolve(): path for path in sorted(paths)}
    return sorted(at for real, at in found.items() if not real.is_relative_to(own))


def _found(model: mujoco.MjModel, kind: str, name: str) -> Path | None:
    """The file that an element was compiled from; None if the compiler dropped it."""
    places = getattr(model, f"{kind}_pathadr")
    for i, place in enumerate(places):
        if place >= 0 and getattr(model, kind)(i).name == name:
            return Path(model.paths[place:].split(b"\0", 1)[0].decode())
    return None
