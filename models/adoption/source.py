"""The file of a robot to adopt: MJCF, URDF, or a model folder of MuJoCo Menagerie."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from tempfile import NamedTemporaryFile

import mujoco

from models.adoption.skeleton import with_rods
from models.description.compiled import named, one_line, read_spec
from models.description.inspection import ROBOT, inspect_model
from models.errors import ModelError, UnknownRobotError
from planner.support import read_file

FREE = re.compile(r"<freejoint|type=\"free\"")
PACKAGE = r'package://([^/"]+)/([^"]+)'
LIMITS = ROBOT._replace(seconds=10)  # much is to be tried with it afterwards
PARENTS = 4  # folders above a URDF in which its packages are looked for
ROOT = "adopted_world"  # link that a URDF's base floats in
FLOATING = f"""
  <link name="{ROOT}"/>
  <joint name="floating_base" type="floating">
    <parent link="{ROOT}"/>
    <child link="{{base}}"/>
  </joint>
"""


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
    path = Path(name)
    if path.is_dir():
        path = _in_folder(path)
    if not path.is_file():
        raise UnknownRobotError(
            f"no such robot: {path}; give an MJCF or URDF file, or a folder with one"
        )
    if path.suffix.lower() != ".urdf":
        inspect_model(path, (), allow_external, LIMITS)
        return Source(path, path, None)
    given = read_file(path).decode(errors="replace")
    found = re.sub(PACKAGE, lambda name: _in_package(path.parent, name), given)
    drawn = with_rods(path, given, found)
    if drawn.text == given:
        inspect_model(path, (), allow_external, LIMITS)
    else:
        with NamedTemporaryFile("w", suffix=".urdf", dir=path.parent) as file:
            file.write(drawn.text)
            file.flush()
            try:
                inspect_model(Path(file.name), (), allow_external, LIMITS)
            except ModelError as error:
                raise ModelError(str(error).replace(file.name, str(path))) from error
    notes = (drawn.note,) if drawn.missing else ()
    return Source(path, path.with_suffix(".xml"), _from_urdf(path, drawn.text), notes)


def _in_folder(folder: Path) -> Path:
    """The MJCF of a folder that has a free joint; scenes only include one."""
    files = sorted(folder.glob("*.xml"), key=lambda f: ("scene" in f.stem, f.name))
    for path in files:
        if path.is_file() and FREE.search(path.read_text(errors="replace")):
            return path
    raise UnknownRobotError(
        f"no robot in {folder}: none of its {len(files)} MJCF files has a free joint; "
        "name the file itself"
    )


def _in_package(folder: Path, name: re.Match[str]) -> str:
    """A file of a ROS package, as a path from the URDF's folder.

    The package is one of the folders that the URDF is in, or stands beside one of them.
    """
    for above in folder.resolve().parents[:PARENTS]:
        found = above.joinpath(*name.groups())
        if found.is_file():
            return os.path.relpath(found, folder.resolve())
    return name.group()


def _from_urdf(path: Path, text: str) -> str:
    """MJCF of a URDF whose base floats, its parts named."""
    links = re.findall(r"<link\s+name=\"([^\"]+)\"", text)
    children = set(re.findall(r"<child\s+link=\"([^\"]+)\"", text))
    bases = [link for link in links if link not in children]
    if not bases or "</robot>" not in text:
        raise ModelError(
            f"not a usable URDF file: {path}; it has {len(bases)} links that are no "
            "child of a joint, where a robot has one"
        )
    joined = text.replace("</robot>", FLOATING.format(base=bases[0]) + "</robot>")
    with one_line(f"not a usable URDF file: {path}"):
        spec = mujoco.MjSpec.from_string(joined)
        own, spec.meshdir = spec.meshdir, str(path.parent / spec.meshdir)
        spec.compile()
    named(spec)
    here = f' meshdir="{spec.meshdir}"'
    # as seen from the folder that the MJCF is written to, wherever that is moved
    return str(spec.to_xml()).replace(here, f' meshdir="{own}"' if own else "", 1)
