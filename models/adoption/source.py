"""The file of a robot to adopt: MJCF, URDF, or a model folder of MuJoCo Menagerie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import mujoco

from models.description.compiled import named, read_spec
from models.description.inspection import inspect_model
from models.errors import ModelError, UnknownRobotError

FREE = re.compile(r"<freejoint|type=\"free\"")
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
    """

    given: Path
    path: Path
    text: str | None

    def spec(self) -> mujoco.MjSpec:
        """A fresh, editable copy of the MJCF."""
        if self.text is None:
            return read_spec(self.path)
        return mujoco.MjSpec.from_string(self.text)


def source_of(name: str, allow_external: bool = False) -> Source:
    """Find the robot behind a path.

    Args:
        name: MJCF or URDF file, or a folder with one robot in MJCF.
        allow_external: Whether it may open files outside its own folder.

    Raises:
        UnknownRobotError: There is no such file, or no robot in the folder.
        ModelError: The file cannot be used.
    """
    path = Path(name)
    if path.is_dir():
        path = _in_folder(path)
    if not path.is_file():
        raise UnknownRobotError(
            f"no such robot: {path}; give an MJCF or URDF file, or a folder with one"
        )
    inspect_model(path, (), allow_external)
    if path.suffix.lower() == ".urdf":
        return Source(path, path.with_suffix(".xml"), _from_urdf(path))
    return Source(path, path, None)


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


def _from_urdf(path: Path) -> str:
    """MJCF of a URDF whose base floats, its parts named."""
    text = path.read_text(encoding="utf-8", errors="replace")
    links = re.findall(r"<link\s+name=\"([^\"]+)\"", text)
    children = set(re.findall(r"<child\s+link=\"([^\"]+)\"", text))
    bases = [link for link in links if link not in children]
    if not bases or "</robot>" not in text:
        raise ModelError(
            f"not a usable URDF file: {path}; it has {len(bases)} links that are no "
            "child of a joint, where a robot has one"
        )
    joined = text.replace("</robot>", FLOATING.format(base=bases[0]) + "</robot>")
    try:
        spec = mujoco.MjSpec.from_string(joined)
        spec.meshdir = spec.meshdir or str(path.parent)
        spec.compile()
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"not a usable URDF file: {path}; {reason}") from error
    named(spec)
    return str(spec.to_xml())
