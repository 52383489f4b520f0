"""The file of a robot to adopt: MJCF, URDF, or a model folder of MuJoCo Menagerie."""

import re
from dataclasses import dataclass
from pathlib import Path

import mujoco

from models.adoption.urdf import mjcf_of
from models.description.compiled import one_line, read_spec
from models.description.inspection import inspect_model
from models.errors import UnknownRobotError, message
from planner.support import read_file

FREE = re.compile(r"<freejoint|type=\"free\"")


@dataclass(frozen=True)
class Source:
    """What to adopt.

    Attributes:
        given: File that was named, or found in a folder; never changed.
        path: MJCF that the card will stand beside.
        text: That MJCF, where it has yet to be written; None if it is the given file.
        notes: What had to be made up, a sentence each.

    Example:
        >>> from models import load, source_of
        >>> source_of(str(load("hexapod").path)).text is None
        True
    """

    given: Path
    path: Path
    text: str | None
    notes: tuple[str, ...] = ()

    def spec(self) -> mujoco.MjSpec:
        """A fresh, editable copy of the MJCF."""
        if self.text is None:
            return read_spec(self.path)
        with one_line(f"cannot be written as MJCF: {self.given}"):
            spec = mujoco.MjSpec.from_string(self.text)
        spec.meshdir = str(self.path.parent / spec.meshdir)
        return spec


def source_of(name: str, allow_external: bool = False) -> Source:
    """Find the robot behind a path.

    Args:
        name: MJCF or URDF file, or a folder with one robot in MJCF.
        allow_external: Whether it may open files outside its own folder.

    Raises:
        UnknownRobotError: There is no such file, or no robot in the folder.
        ModelError: The file cannot be used.

    Example:
        >>> from models import load, source_of
        >>> source_of(str(load("hexapod").path)).path.name
        'hexapod.xml'
    """
    path, notes = Path(name), tuple[str, ...]()
    if path.is_dir():
        path, *others = _in_folder(path)
        notes = tuple(f"{path.name}, as {one.name} is a robot, too" for one in others)
    if not path.is_file() or path.suffix not in (".xml", ".urdf"):
        raise UnknownRobotError(message("no_robot", path=path))
    if path.suffix != ".urdf":
        inspect_model(path, (), allow_external)
        return Source(path, path, None, notes)
    text, made_up = mjcf_of(path, allow_external)
    return Source(path, path.with_suffix(".xml"), text, made_up)


def _in_folder(folder: Path) -> list[Path]:
    """The MJCF files of a folder that have a free joint; scenes only include one."""
    files = sorted(folder.glob("*.xml"), key=lambda f: ("scene" in f.stem, f.name))
    texts = ((p, read_file(p).decode(errors="replace")) for p in files if p.is_file())
    if found := [path for path, text in texts if FREE.search(text)]:
        return found
    raise UnknownRobotError(message("no_free", count=len(files), folder=folder))
