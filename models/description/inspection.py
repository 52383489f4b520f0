"""Inspection of a user's model before it is read: size, numbers, and files it opens.

A line of MJCF that copies parts often enough keeps MuJoCo busy for minutes and fills
gigabytes; a process with limits, this module run as a program, compiles it first. A run
copies the files that its model names: those outside its folder are refused.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco

from models.description import compiled
from models.errors import ModelError

NAMED = re.compile(r"""\bfile\w*\s*=\s*["']([^"']{1,200})["']""")


@dataclass(frozen=True, slots=True)
class Opened:
    """The files that make a model."""

    files: tuple[Path, ...] = ()  # all of them, the MJCF included
    external: tuple[Path, ...] = ()  # those outside its own folder


def included(path: Path) -> list[Path]:
    """An MJCF file and the files that it includes or attaches, and may be more."""
    _refuse_pipes(path, set())
    with compiled.one_line(f"not a usable MJCF file: {path}"):
        named = [Path(name) for name in mujoco.mju_getXMLDependencies(str(path))]
    for other in named:
        if other.exists() and not other.is_file():  # a pipe would be waited for
            raise _no_file(other, path)
    return [other for other in named if other.is_file()]


def _no_file(other: Path, path: Path) -> ModelError:
    return ModelError(f"not a file: {other}, which {path} names; correct it")


def _refuse_pipes(path: Path, seen: set[Path]) -> None:
    """Refuse what a file, and those that it names, would be waited for.

    Names that are spelt otherwise are not found here, and waited for until time is up.
    """
    seen.add(path)
    if not path.exists() or path.stat().st_size > 10**7:  # bytes to search
        return
    for name in NAMED.findall(path.read_text("utf-8", "replace")):
        other = path.parent / name
        if other in seen or "\0" in name or not other.exists():
            continue
        if other.is_file():
            _refuse_pipes(other, seen)
        elif not other.is_dir():
            raise _no_file(other, path)


def elements_with_files(
    spec: mujoco.MjSpec, model: mujoco.MjModel
) -> Iterator[tuple[Any, str, Path | None]]:
    """Elements that may have a file, their folder, and where the compiler found it."""
    for kind, elements, folder in (
        ("mesh", spec.meshes, "meshdir"),
        ("hfield", spec.hfields, "meshdir"),
        ("skin", spec.skins, "meshdir"),
        ("tex", spec.textures, "texturedir"),
    ):
        for part in elements:
            yield part, getattr(part.compiler, folder), _found(model, kind, part.name)


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
    own = folder.resolve()
    # not Path.resolve, to which a link to itself is an error
    found = {Path(os.path.realpath(path)): path for path in sorted(paths)}
    return sorted(at for real, at in found.items() if not real.is_relative_to(own))


def _found(model: mujoco.MjModel, kind: str, name: str) -> Path | None:
    """The file that an element was compiled from; None if the compiler dropped it."""
    for i, place in enumerate(getattr(model, f"{kind}_pathadr")):
        if place >= 0 and getattr(model, kind)(i).name == name:
            return Path(model.paths[place:].split(b"\0", 1)[0].decode())
    return None


SECONDS = 8  # of the processor, in which a model must compile
MEMORY = 2 * 10**9  # bytes
ROOT = Path(__file__).resolve().parents[2]
SHOWN = 3  # files that a message names


def inspect_model(
    path: Path,
    others: tuple[Path, ...] = (),
    allow_external: bool = False,
    remedy: str = "move them there, or give --allow-external if you trust it",
) -> Opened:
    """Make sure that a model may be read, and find the files that it opens.

    Other files belong to it, too. Refused are models that are too large, do not
    compile, have odd names or numbers that are not finite, or open files that they may
    not, where a `remedy` is named. This costs the start of a process.
    """
    compiled.check_name(path.stem, str(path))
    if re.search(r"[\\\ud800-\udfff]", str(path.absolute())):
        raise compiled.refusal("backslash", path.absolute())
    files = {Path(file) for file in _tried(path)}
    taken = outside((files | set(others)) - {path}, path.parent)
    if taken and not allow_external:
        named = ", ".join(map(str, taken[:SHOWN]))
        more = f" and {len(taken) - SHOWN} more" if len(taken) > SHOWN else ""
        raise compiled.refusal("outside", path, named=named + more, remedy=remedy)
    return Opened(tuple(sorted(files | {path})), tuple(taken))


def _tried(path: Path) -> list[str]:
    """The files that a model opens, as the process that compiled it says."""
    path.open("rb").close()  # which says in time that it may not be read
    gigabytes = MEMORY // 10**9
    too_large = compiled.refusal("large", path, seconds=SECONDS, gigabytes=gigabytes)
    # No pictures, one thread, no room set aside for others, and this code whatever
    # else is installed.
    paths = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    single = dict.fromkeys(("OPENBLAS_NUM_THREADS", "MALLOC_ARENA_MAX"), "1")
    quick = {"MUJOCO_GL": "disabled", "PYTHONIOENCODING": "utf-8", **single}
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-m", __spec__.name, str(path)],
            env={**os.environ, **quick, "PYTHONPATH": paths},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=30,  # [s] by the clock
        )
    except subprocess.TimeoutExpired:
        raise too_large from None
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise too_large
    lines = done.stdout.decode(errors="replace").splitlines()
    if done.returncode or not lines:
        raise compiled.refusal("crash", path)
    report = json.loads(lines[-1])
    if "large" in report:
        raise too_large
    if "wrong" in report:
        raise ModelError(report["wrong"])
    return list(report["files"])


HANDY = 35 * 10**7  # bytes of a compiled model, of which copies are made, and of states
DRAWN = 170  # bytes that a picture of a height field takes for each height
FACE, SHAPE = 10, 10_000  # a quarter of what the replay takes for a face, and a geom
DENSE = 64  # bytes of matrices that tell whether explicit steps are stable
NAMING = 0.5  # seconds of the processor, a hundred times what robots take
MOST_KEYS = 1000  # keyframes, of which each takes long to leave out among many
STATES_KEPT, HISTORIES = 1000, 10  # of a walk that are kept at once, at most
TOO_LARGE = ("Could not allocate memory", "allocation failed", "unknown exception")
"""What MuJoCo says where memory ends."""


def examine(path: Path) -> list[Path]:
    """The files that a model opens, itself included, once it has been compiled."""
    texts = included(path)
    compiled.check_text(path)
    model = compiled.compile_model(compiled.read_spec(path), str(path))
    if model.nflex:
        raise compiled.refusal("flexes", path, count=model.nflex)
    numbers = model.nsensordata + model.nuserdata + model.na + model.nq + model.nv
    size = mujoco.mj_sizeModel(model) + DRAWN * model.nhfielddata
    meshes = model.geom_dataid[model.geom_type == mujoco.mjtGeom.mjGEOM_MESH]
    size += FACE * int(model.mesh_facenum[meshes].sum()) + SHAPE * model.ngeom
    size += 8 * (STATES_KEPT * numbers + HISTORIES * model.nhistory)
    size += DENSE * model.nv**2
    if size > HANDY:
        facts = {"states": STATES_KEPT, "size": size / 1e9, "most": HANDY / 1e9}
        raise compiled.refusal("large_states", path, **facts)
    cannot = f"MuJoCo cannot run the model: {path}", "too small a <size memory>?"
    with compiled.one_line(*cannot):
        data = mujoco.MjData(model)
        for key in [*range(model.nkey), -1]:  # -1: as the file has it
            mujoco.mj_resetDataKeyframe(model, data, key)
            mujoco.mj_step(model, data)
    spec = compiled.read_spec(path)
    compiled.check_quaternions(spec, model, str(path))
    files = assets(spec, model)  # compiling may drop some from a spec
    drawings = {*map(os.path.realpath, files)}
    for text in (other for other in texts if os.path.realpath(other) not in drawings):
        compiled.check_text(text)
    for file in sorted(files):
        if not file.is_file():
            raise compiled.refusal("missing", path, file=file)
    began = time.process_time()
    compiled.named(spec)  # as whoever reads it does; its time grows with the square
    if model.nkey > MOST_KEYS or time.process_time() - began > NAMING:
        raise compiled.refusal("many", path, most=NAMING, keys=MOST_KEYS)
    return sorted({path, *texts, *files})


def report(path: Path) -> dict[str, object]:
    """The `files` of a usable model, what is `wrong` with it, or that it is `large`."""
    try:
        return {"files": [str(file) for file in examine(path)]}
    except ModelError as error:
        large = any(sign in str(error) for sign in TOO_LARGE)
        return {"large": True} if large else {"wrong": str(error)}
    except OSError as error:
        what = f"{error.filename} cannot be read, {error.strerror}"
        return {"wrong": f"{what}: {path} names it; let it be read, or leave it out"}
    except MemoryError:
        return {"large": True}


def main(path: str) -> None:
    """Try a model within limits of time and memory; print the report."""
    import resource  # not on every system

    wanted = {"RLIMIT_CPU": SECONDS, "RLIMIT_AS": MEMORY, "RLIMIT_CORE": 0}
    for name, most in wanted.items():
        kind = getattr(resource, name)
        _, hard = resource.getrlimit(kind)  # -1 where there is none
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (most, most))
    print("", json.dumps(report(Path(path))), sep="\n", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
