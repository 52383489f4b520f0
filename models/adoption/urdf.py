"""A URDF as MJCF: its base floats, its files are found, and its shapes collide.

Drawings are often passed on without their meshes. The links of such a URDF are drawn as
rods from frame to frame: where the next joint is says how long a link is, and the last
one of a leg ends as far beyond its centre of mass as that is from its joint. Where no
link has a shape that collides, the shapes that are only drawn do.
"""

import os
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from math import atan2, hypot
from pathlib import Path
from tempfile import NamedTemporaryFile
from xml.sax.saxutils import quoteattr

import mujoco

from models.adoption.words import first, guess, refusal
from models.description.compiled import check_text, named, one_line
from models.description.inspection import inspect_model
from models.errors import ModelError
from planner.support import read_file

ROOT = "adopted_world"  # link that a URDF's base floats in
FILE = re.compile(r"""package://([^/"']+)/([^"']+)""")
SLOW = 2.0  # [rad/s]; legs swing at half a radian a second, and lift at one
Point = tuple[float, float, float]


def mjcf_of(path: Path, allow_external: bool) -> tuple[str, tuple[str, ...]]:
    """The MJCF of a URDF, seen from its folder, and notes of what was made up."""
    given = read_file(path).decode(errors="replace")
    check_text(path)
    found = with_packages(given, path.parent)
    drawn, notes = with_shapes(path, given, re.sub("(?<=[\"'])file://", "", found))
    if drawn == given:
        inspect_model(path, (), allow_external)
    else:
        with NamedTemporaryFile(
            "w", encoding="utf-8", prefix=".", suffix=".urdf", dir=path.parent
        ) as file:
            file.write(drawn)
            file.flush()
            try:
                inspect_model(Path(file.name), (), allow_external)
            except ModelError as error:
                raise ModelError(str(error).replace(file.name, str(path))) from error
    return _floating(path, drawn), notes


def with_packages(text: str, folder: Path) -> str:
    """A URDF that names files of packages that are there by paths from its folder."""
    return FILE.sub(lambda name: _found(folder.resolve(), name), text)


def _found(folder: Path, name: re.Match[str]) -> str:
    """A file of a package above or beside the URDF, which may be in it itself."""
    above = (folder, *folder.parents[:4])  # a few folders up
    places = [at / name[2] for at in above if _called(at) == name[1]]
    for at in above:  # a package is often kept in a folder of another name
        places += [at.joinpath(*name.groups()), *[at / name[2]] * (not _called(at))]
    found = next(filter(os.path.isfile, places), None)
    return os.path.relpath(found, folder) if found else name.group()


def _called(folder: Path) -> str:
    """What the package in a folder is called; empty where nothing there says so."""
    text = ""
    with suppress(OSError):
        text = read_file(folder / "package.xml", 10**5).decode(errors="replace")
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    return (re.findall(r"<name>([^<]*)</name>", text) or [""])[0].strip()


def _floating(path: Path, text: str) -> str:
    """MJCF of a URDF whose base floats, its parts named, as seen from its folder."""
    try:
        robot = _parsed(text)
    except ET.ParseError as error:
        raise refusal("no_xml", path, why=error) from None
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    links = (str(link.get("name")) for link in robot.iterfind("link"))
    if not (bases := [name for name in links if name not in children]):
        raise refusal("bases", path)
    if bases[0] == "world":
        raise refusal("world", path)
    if len(bases) > 1:
        raise refusal("apart", path, one=bases[0], other=bases[1])
    if (own := robot.find("joint[@type='floating']")) is not None:
        raise refusal("floating", path, joint=own.get("name"))
    joints = Counter(joint.get("name") for joint in robot.iterfind("joint"))
    if twice := [name for name, count in joints.items() if count > 1]:
        raise refusal("twice", path, joint=twice[0])
    limited, ends = set(), {"lower": "0", "upper": "0"}
    for joint in robot.iterfind("joint[@type!='continuous']"):
        for limit in joint.iterfind("limit"):
            if ends.keys() & limit.attrib.keys():
                limit.attrib.update(ends | limit.attrib)  # what is left out is 0
                limited.add(joint.get("name"))
    ET.SubElement(robot, "link", name=ROOT)
    floats = ET.SubElement(robot, "joint", name="floating_base", type="floating")
    ET.SubElement(floats, "parent", link=ROOT)
    ET.SubElement(floats, "child", link=bases[0])
    with one_line(f"not a usable URDF file: {path}"):
        spec = mujoco.MjSpec.from_string(ET.tostring(robot, encoding="unicode"))
        own, spec.meshdir = spec.meshdir, str(path.parent / spec.meshdir)
        spec.compiler.fusestatic = True  # without which the link that we add has a body
        for joint in spec.joints:  # the compiler would take these limits for none
            low, high = joint.range
            if low >= high and joint.name in limited:
                raise refusal("limits", path, joint=joint.name, low=low, high=high)
        spec.compile()
    named(spec)
    here = f" meshdir={quoteattr(own)}" if own else ""
    return re.sub(' meshdir="[^"]*"', lambda _: here, str(spec.to_xml()), count=1)


def _parsed(text: str) -> ET.Element:
    """The root of a text, its elements without their namespace, or those of others."""
    if hides := re.search("<!(ENTITY|ATTLIST)", text):  # what the engine does not read
        raise ET.ParseError(f"{hides[0]}> is not read; take it out")
    root = ET.fromstring(text)
    if asked := [e.tag.partition("}")[2] for e in root.iter() if "/xacro}" in e.tag]:
        raise ET.ParseError(f"<xacro:{asked[0]}> is not read; expand it with xacro")
    space = root.tag[: root.tag.find("}") + 1]
    for element in root.iter():
        element[:] = [e for e in element if e.tag.rpartition("}")[0] == space[:-1]]
        element.tag = element.tag.removeprefix(space)
    return root


def with_shapes(path: Path, given: str, text: str) -> tuple[str, tuple[str, ...]]:
    """The URDF with shapes that collide, rods for missing meshes, and notes of both.

    The text is what was given, with the files of packages found.
    """
    try:
        robot, written = _parsed(text), _parsed(given)
        ET.tostring(robot)  # which needs Python's stack
    except ET.ParseError:  # the compiler says it better
        return text, ()
    except RecursionError:
        raise ModelError(f"nested too deeply: {path}; take elements out") from None
    notes, visuals = tuple(_unsaid(robot)), robot.findall("link/visual")
    if drawn := bool(visuals) and robot.find("link/collision") is None:
        notes = guess("drawn"), *notes
        for visual in visuals:
            visual.tag = "collision"
    told = getattr(robot.find("mujoco/compiler"), "attrib", {})
    folder, strip = path.parent / told.get("meshdir", ""), told.get("strippath")
    names = [str(mesh.get("filename")) for mesh in written.iter("mesh")]
    absent = {
        id(mesh): name
        for mesh, name in zip(robot.iter("mesh"), names, strict=True)
        for file in (Path(mesh.get("filename", "")),)
        if not os.path.exists(folder / (file.name if strip == "true" else file))
    }
    if not absent:
        same = not (drawn or re.search(r"xmlns\s*=", text))  # or prefixes hide names
        return text if same else ET.tostring(robot, encoding="unicode"), notes
    ends = _ends(robot)
    longest = max((hypot(*end) for found in ends.values() for end in found), default=0)
    missing: dict[str, None] = {}  # in order
    for link in list(robot.iter("link")):
        meshes = ((s, absent.get(id(m))) for s in link for m in s.iter("mesh"))
        lost = {shape: name for shape, name in meshes if name is not None}
        for shape in lost:
            link.remove(shape)
        if lost and link.find("collision") is None:
            missing |= dict.fromkeys(lost.values())
            _draw(path, link, ends[str(link.get("name"))], 0.06 * longest)  # thick
        elif fewer := [name for s, name in lost.items() if s.tag == "collision"]:
            notes += (guess("fewer", shown=first(fewer), link=link.get("name")),)
    if missing:
        notes += (guess("rods", shown=first([*missing])),)
    return ET.tostring(robot, encoding="unicode"), notes


def _unsaid(robot: ET.Element) -> Iterator[str]:
    """Notes of links whose mass is made up, and of joints whose speed is not kept."""
    shaped = (link for link in robot.iterfind("link[collision]"))
    light = [str(link.get("name")) for link in shaped if link.find("inertial") is None]
    if light:
        yield guess("water", links=first(light))
    speeds = {
        str(joint.get("name")): float(limit.get("velocity", ""))
        for joint in robot.iterfind("joint")
        for limit in joint.iterfind("limit[@velocity]")
        if re.fullmatch(r"\d+\.?\d*|\.\d+", limit.get("velocity", ""))
    }
    slow = [joint for joint, speed in speeds.items() if 0 < speed <= SLOW]
    if slow:
        least = min(speeds[joint] for joint in slow)
        yield guess("speeds", joints=first(slow), least=least)


def _ends(robot: ET.Element) -> dict[str, list[Point]]:
    """Where the next joints of each link are; the end of its rod if there are none."""
    ends: dict[str, list[Point]] = {}
    for joint in robot.iter("joint"):
        if (parent := joint.find("parent")) is not None:
            place = _place(joint.find("origin"))
            ends.setdefault(str(parent.get("link")), []).append(place)
    links = {str(link.get("name")): link for link in robot.iter("link")}
    for name in links.keys() - ends:
        x, y, z = _place(links[name].find("inertial/origin"))
        ends[name] = [(2 * x, 2 * y, 2 * z)]
    return {name: ends[name] for name in links}


def _place(origin: ET.Element | None) -> Point:
    given = "0 0 0" if origin is None else origin.get("xyz", "0 0 0")
    try:
        x, y, z = map(float, given.split())
    except ValueError:  # the compiler refuses it
        return (0.0, 0.0, 0.0)
    return (x, y, z)


def _draw(path: Path, link: ET.Element, ends: list[Point], radius: float) -> None:
    """Add rods to a link, and a ball at the end of each."""
    if not any(hypot(*end) for end in ends):
        raise refusal("no_end", path, link=link.get("name"))
    for x, y, z in ends:
        across, length = hypot(x, y), hypot(x, y, z)
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
