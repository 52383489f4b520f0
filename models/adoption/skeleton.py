"""A URDF without its meshes, whose links are drawn as rods from frame to frame.

Drawings are often passed on without their meshes. Where the next joint is says how long
a link is; the last one of a leg ends as far beyond its centre of mass as that is from
its joint.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from math import atan2, hypot, sqrt
from pathlib import Path

from models.errors import ModelError

THICKNESS = 0.06  # radius of a rod in lengths of the longest one
SHOWN = 2  # names of meshes in a sentence

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Skeleton:
    """A URDF in which every mesh is there, and what it lacked."""

    text: str
    missing: tuple[str, ...] = ()  # meshes, as they were written

    @property
    def note(self) -> str:
        """What was done about meshes that are missing, as a sentence."""
        more = len(self.missing) - SHOWN
        names = ", ".join(self.missing[:SHOWN]) + (f" and {more} more" * (more > 0))
        return (
            f"its meshes are missing, {names}: links are rods from joint to joint, and "
            "legs end at twice the distance of their centre of mass; put the meshes "
            "there, or correct the feet"
        )


def with_rods(path: Path, given: str, text: str) -> Skeleton:
    """The URDF, its links drawn as rods where their meshes are missing.

    The text is what was given, with the files of packages found.
    """
    if "<mesh" not in text or "<!" in text.replace("<!--", ""):  # no entities
        return Skeleton(text)
    try:
        robot, written = ET.fromstring(text), ET.fromstring(given)
    except ET.ParseError:  # the compiler says it better
        return Skeleton(text)
    names = [str(mesh.get("filename")) for mesh in written.iter("mesh")]
    absent = {
        id(mesh): name
        for mesh, name in zip(robot.iter("mesh"), names, strict=True)
        if not _exists(path.parent, str(mesh.get("filename")))
    }
    if not absent:
        return Skeleton(text)
    ends = _ends(robot)
    longest = max(_length(end) for found in ends.values() for end in found)
    for link in list(robot.iter("link")):
        shapes = [s for s in link if any(id(m) in absent for m in s.iter("mesh"))]
        for shape in shapes:
            link.remove(shape)
        if shapes and link.find("collision") is None:
            _draw(path, link, ends[str(link.get("name"))], THICKNESS * longest)
    missing = tuple(dict.fromkeys(absent.values()))
    return Skeleton(ET.tostring(robot, encoding="unicode"), missing)


def _exists(folder: Path, name: str) -> bool:
    """Whether a name is taken, by a file or by what the inspection refuses."""
    try:
        return folder.joinpath(name.removeprefix("file://")).exists()
    except ValueError:  # a zero byte
        return False


def _ends(robot: ET.Element) -> dict[str, list[Point]]:
    """Where the next joints of each link are; the end of its rod if there are none."""
    ends: dict[str, list[Point]] = {
        str(part.get("name")): [] for part in robot.iter("link")
    }
    for joint in robot.iter("joint"):
        parent = joint.find("parent")
        if parent is not None and parent.get("link") in ends:
            ends[str(parent.get("link"))].append(_place(joint.find("origin")))
    for link in robot.iter("link"):
        if not (found := ends[str(link.get("name"))]):
            x, y, z = _place(link.find("inertial/origin"))
            found.append((2 * x, 2 * y, 2 * z))
    return ends


def _place(origin: ET.Element | None) -> Point:
    given = "0 0 0" if origin is None else origin.get("xyz", "0 0 0")
    try:
        x, y, z = map(float, given.split())
    except ValueError:  # the compiler refuses it
        return (0.0, 0.0, 0.0)
    return (x, y, z)


def _length(end: Point) -> float:
    return sqrt(sum(part * part for part in end))


def _draw(path: Path, link: ET.Element, ends: list[Point], radius: float) -> None:
    """Add rods to a link, and a ball at the end of each."""
    if not any(map(_length, ends)):
        raise ModelError(
            f"no end of link {link.get('name')!r} is known: {path}; its mesh is "
            "missing, and it has neither a next joint nor a centre of mass, add one"
        )
    for x, y, z in ends:
        across, length = hypot(x, y), _length((x, y, z))
        if length > radius:
            middle, turn = (x / 2, y / 2, z / 2), (0.0, atan2(across, z), atan2(y, x))
            rod = {"radius": f"{radius / 2:.6g}", "length": f"{length:.6g}"}
            _add(link, "cylinder", rod, middle, turn)
        _add(link, "sphere", {"radius": f"{radius:.6g}"}, (x, y, z))


def _add(
    link: ET.Element,
    shape: str,
    sizes: dict[str, str],
    place: Point,
    turn: Point = (0.0, 0.0, 0.0),
) -> None:
    part = ET.SubElement(link, "collision")
    xyz, rpy = (" ".join(f"{value:.9g}" for value in at) for at in (place, turn))
    ET.SubElement(part, "origin", {"xyz": xyz, "rpy": rpy})
    ET.SubElement(ET.SubElement(part, "geometry"), shape, sizes)
