"""A morphology as MJCF: bodies, joints, servos, cameras, sensors and a keyframe.

The file is meant to be read by people: it has the lengths of the morphology, axes
instead of quaternions, and one default class for each kind of part.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from models.morphology.dimensions import Leg, Morphology

INK, ACCENT = "0.25 0.29 0.35 1", "0.95 0.55 0.15 1"
COLOURS = (  # of the groups; pictures mark their footprints alike
    "0.16 0.44 0.75 1",
    "0.80 0.27 0.24 1",
    "0.87 0.82 0.20 1",
    "0.98 0.67 0.63 1",
    "0.44 0.56 0.69 1",
    "0.44 0.31 0.03 1",
)
CONTACT_DATA = "found force pos linvel"


def write_mjcf(shape: Morphology, groups: Sequence[Container[int]]) -> str:
    """MJCF of the robot on the floor of `scene.xml`, one colour a group of legs."""
    root = Element("mujoco", model=shape.name)
    SubElement(root, "include", file="scene.xml")
    _defaults(root, shape)
    torso = _torso(SubElement(root, "worldbody"), shape)
    for number, leg in shape.legs.items():
        of = next(i for i, group in enumerate(groups) if number in group)
        _leg(torso, shape, number, leg, COLOURS[of % len(COLOURS)])
    actuators, sensors = SubElement(root, "actuator"), SubElement(root, "sensor")
    for number, leg in shape.legs.items():
        for kind in ("swing", "lift"):
            joint = f"{kind}_{number}"
            own = _limits("ctrlrange", shape, leg) if kind == "swing" else {}
            attributes = {"class": kind, **own}
            SubElement(
                actuators, "position", name=joint, joint=joint, attrib=attributes
            )
            SubElement(sensors, "jointpos", name=joint, joint=joint)
    for n in shape.legs:
        touching = {"geom1": "floor", "geom2": f"foot_{n}", "data": CONTACT_DATA}
        SubElement(sensors, "contact", name=f"contact_foot_{n}", attrib=touching)
    SubElement(sensors, "framepos", name="position", objtype="xbody", objname="torso")
    SubElement(
        sensors, "framequat", name="orientation", objtype="xbody", objname="torso"
    )
    SubElement(sensors, "subtreecom", name="center_of_mass", body="torso")
    angles = [angle for leg in shape.legs.values() for angle in (leg.turned, 0)]
    qpos = _numbers(0, 0, shape.hip_height, 1, 0, 0, 0, *angles)
    start = SubElement(SubElement(root, "keyframe"), "key", name="start", qpos=qpos)
    if any(angles):
        start.set("ctrl", _numbers(*angles))
    indent(root)
    return tostring(root, encoding="unicode").replace(" />", "/>") + "\n"


def _numbers(*values: float) -> str:
    """Values as text with twelve digits, without rounding noise."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)


def _defaults(root: Element, shape: Morphology) -> None:
    """One class a kind of part, so that the body below shows only what differs."""
    default = SubElement(
        SubElement(root, "default"), "default", attrib={"class": "robot"}
    )
    # Robots touch floor and walls, never themselves: legs clear each other in range.
    SubElement(default, "geom", contype="0", conaffinity="1", rgba=INK)
    servo = {"kp": _numbers(shape.stiffness), "kv": _numbers(shape.damping)}
    ranges = {
        "swing": (-shape.swing_range, shape.swing_range),
        "lift": shape.lift_range,
    }
    for kind, axis in (("swing", "0 0 1"), ("lift", "0 -1 0")):
        part = SubElement(default, "default", attrib={"class": kind})
        limits = _numbers(*ranges[kind])
        inertia = _numbers(shape.armature)
        SubElement(
            part, "joint", axis=axis, range=limits, limited="true", armature=inertia
        )
        SubElement(part, "position", ctrlrange=limits, attrib=servo)
    link = SubElement(default, "default", attrib={"class": "link"})
    SubElement(link, "geom", type="capsule", size=_numbers(shape.leg_radius))
    foot = SubElement(default, "default", attrib={"class": "foot"})
    SubElement(foot, "geom", type="sphere", size=_numbers(shape.foot_radius))


def _limits(attribute: str, shape: Morphology, leg: Leg) -> dict[str, str]:
    """Limits of a swing joint that stands turned; the others have their class's."""
    if not leg.turned:
        return {}
    span = (leg.turned - shape.swing_range, leg.turned + shape.swing_range)
    return {attribute: _numbers(*span)}


def _torso(world: Element, shape: Morphology) -> Element:
    """The body plate, a nose that shows where the front is, and the cameras."""
    pos = _numbers(0, 0, shape.hip_height)
    torso = SubElement(world, "body", name="torso", childclass="robot", pos=pos)
    SubElement(torso, "freejoint", name="root")
    length, width, thickness = shape.plate
    raised = shape.hip_radius + thickness
    plate = {"pos": _numbers(0, 0, raised), "size": _numbers(*shape.plate)}
    SubElement(
        torso,
        "geom",
        name="plate",
        type="box",
        mass=_numbers(shape.body_mass),
        attrib=plate,
    )
    nose = {
        "pos": _numbers(0.85 * length, 0, raised + 2 * thickness),
        "size": _numbers(0.15 * length, 0.35 * width, thickness),
        "rgba": ACCENT,
        "conaffinity": "0",
    }
    SubElement(torso, "geom", name="nose", type="box", mass="0", attrib=nose)
    _cameras(
        torso, far=4 * max(abs(c) for leg in shape.legs.values() for c in leg.foot)
    )
    return torso


def _cameras(torso: Element, far: float) -> None:
    for name, place, axes in (
        ("top", (0, 0, 1), (0, -1, 0, 1, 0, 0)),
        ("side", (0, -1, 0.3), (1, 0, 0, 0, 0.29, 0.957)),
        ("chase", (-0.7, -0.5, 0.6), (0.58, -0.81, 0, 0.46, 0.33, 0.82)),
    ):
        pose = {"pos": _numbers(*(far * p for p in place)), "xyaxes": _numbers(*axes)}
        SubElement(torso, "camera", name=name, mode="trackcom", fovy="40", attrib=pose)


def _leg(torso: Element, shape: Morphology, number: int, leg: Leg, colour: str) -> None:
    """A leg along its own x axis: the swing axis vertical, the lift axis horizontal."""
    cos, sin = leg.direction
    axes = _numbers(cos, sin, 0, -sin, cos, 0)
    body = SubElement(
        torso, "body", name=f"leg_{number}", pos=_numbers(*leg.hip, 0), xyaxes=axes
    )
    for kind in ("swing", "lift"):
        own = _limits("range", shape, leg) if kind == "swing" else {}
        attributes = {"class": kind, **own}
        SubElement(body, "joint", name=f"{kind}_{number}", attrib=attributes)
    hip = {"type": "sphere", "size": _numbers(shape.hip_radius), "mass": "0"}
    SubElement(body, "geom", name=f"hip_{number}", attrib=hip)
    knee = (0.55 * leg.length, 0, 0.35 * shape.hip_height)
    foot = (leg.length, 0, shape.foot_radius - shape.hip_height)
    for name, ends, share in (
        ("femur", (0, 0, 0, *knee), 0.45),
        ("tibia", (*knee, *foot), 0.35),
    ):
        part = {"class": "link", "fromto": _numbers(*ends), "rgba": colour}
        mass = _numbers(share * shape.leg_mass)
        SubElement(body, "geom", name=f"{name}_{number}", mass=mass, attrib=part)
    part = {"class": "foot", "pos": _numbers(*foot), "rgba": colour}
    mass = _numbers(0.2 * shape.leg_mass)
    SubElement(body, "geom", name=f"foot_{number}", mass=mass, attrib=part)
