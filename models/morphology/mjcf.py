"""Dimensions of a robot whose legs have two joints, and the MJCF written from them.

Body frame: x forward, y left, z up, origin at the height of the hips above the point
where x = y = 0. SI units, radians. The file is meant to be read by people: it has axes
instead of quaternions, and one default class for each kind of part.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, radians, sin
from xml.etree.ElementTree import Element, SubElement, indent, tostring

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight leg seen from above, as the robot stands."""

    hip: Point  # where the swing axis is [m]
    foot: Point  # [m]
    turned: float = 0.0  # swing joint's angle when standing [rad]

    @property
    def length(self) -> float:
        """Horizontal distance from swing axis to foot at lift 0 [m]."""
        return hypot(self.foot[0] - self.hip[0], self.foot[1] - self.hip[1])

    @property
    def direction(self) -> Point:
        """Unit vector from the swing axis to the foot when the swing joint is at 0."""
        dx, dy = self.foot[0] - self.hip[0], self.foot[1] - self.hip[1]
        c, s = cos(self.turned) / self.length, sin(self.turned) / self.length
        return (c * dx + s * dy, c * dy - s * dx)

    def __post_init__(self) -> None:
        if self.length <= 0:
            raise ValueError(f"leg of length 0: hip and foot are both at {self.hip}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Morphology:
    """A body plate on legs. Legs are numbered front to back, odd left, even right."""

    name: str
    legs: Mapping[int, Leg]
    hip_height: float  # [m] above the floor
    plate: tuple[float, float, float]  # half sizes of the body plate [m]
    body_mass: float  # [kg], without legs
    leg_mass: float  # [kg], each
    leg_radius: float  # [m]
    hip_radius: float  # [m]
    foot_radius: float  # [m]
    swing_range: float  # [rad], either side of standing
    lift_range: tuple[float, float]  # [rad]
    stiffness: float  # position servo, [N m/rad]
    damping: float  # position servo, [N m s/rad]
    armature: float  # reflected rotor inertia, [kg m^2]

    def __post_init__(self) -> None:
        for field in ("hip_height", "body_mass", "leg_mass", "stiffness", "armature"):
            value = getattr(self, field)
            if not value > 0:
                raise ValueError(f"{self.name}: {field} must be positive, got {value}")

    @property
    def mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return self.body_mass + self.leg_mass * len(self.legs)


def legs_towards_pivots(
    feet: Mapping[int, Point], pivots: Mapping[int, Point], kappa: float
) -> dict[int, Leg]:
    """Legs whose lines, extended inward, meet at the pivot of their tripod.

    A planted foot moves at right angles to its leg, so three legs hold a rotation of
    the body without slip exactly when their lines meet at its centre. One radian of
    swing then turns the body about the pivot by `kappa`, the leg's length as a fraction
    of the distance from pivot to foot. Places are those at swing 0, body frame [m].
    """
    legs = {}
    for number, (fx, fy) in feet.items():
        px, py = pivots[number]
        hip = (px + (1 - kappa) * (fx - px), py + (1 - kappa) * (fy - py))
        legs[number] = Leg(hip, (fx, fy))
    return legs


def legs_on_a_circle(
    bearings: Mapping[int, float],
    radius: float,
    length: float,
    pivots: Mapping[int, Point],
) -> dict[int, Leg]:
    """Radial legs of one length that stand turned in line with their group's pivot.

    A bearing [degrees] is the direction of a hip from the middle, at that radius [m],
    and of its leg when the swing joint is at 0; pivots are in the body frame [m].
    """
    legs = {}
    for number, degrees in bearings.items():
        bearing = radians(degrees)
        hip = (radius * cos(bearing), radius * sin(bearing))
        px, py = pivots[number]
        along = atan2(hip[1] - py, hip[0] - px)
        foot = (hip[0] + length * cos(along), hip[1] + length * sin(along))
        turned = atan2(sin(along - bearing), cos(along - bearing))
        legs[number] = Leg(hip, foot, turned)
    return legs


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
Value = str | float | tuple[float, ...] | None  # of an attribute


def write_mjcf(shape: Morphology, groups: Sequence[Container[int]]) -> str:
    """MJCF of the robot on the floor of `scene.xml`, one colour a group of legs."""
    root = Element("mujoco", model=shape.name)
    _add(root, "include", file="scene.xml")
    _defaults(root, shape)
    torso = _torso(_add(root, "worldbody"), shape)
    for number, leg in shape.legs.items():
        of = next(i for i, group in enumerate(groups) if number in group)
        _leg(torso, shape, number, leg, COLOURS[of % len(COLOURS)])
    actuators, sensors = _add(root, "actuator"), _add(root, "sensor")
    for number, leg in shape.legs.items():
        for kind in ("swing", "lift"):
            joint = f"{kind}_{number}"
            span = {"ctrlrange": _span(shape, leg)} if kind == "swing" else {}
            _add(actuators, "position", class_=kind, **span, name=joint, joint=joint)
            _add(sensors, "jointpos", name=joint, joint=joint)
    for n in shape.legs:
        touching = {"geom1": "floor", "geom2": f"foot_{n}", "data": CONTACT_DATA}
        _add(sensors, "contact", **touching, name=f"contact_foot_{n}")
    for kind, name in (("framepos", "position"), ("framequat", "orientation")):
        _add(sensors, kind, name=name, objtype="xbody", objname="torso")
    _add(sensors, "subtreecom", name="center_of_mass", body="torso")
    angles = tuple(angle for leg in shape.legs.values() for angle in (leg.turned, 0))
    qpos = (0, 0, shape.hip_height, 1, 0, 0, 0, *angles)
    ctrl = angles if any(angles) else None
    _add(_add(root, "keyframe"), "key", name="start", qpos=qpos, ctrl=ctrl)
    indent(root)
    return tostring(root, encoding="unicode").replace(" />", "/>") + "\n"


def _add(parent: Element, tag: str, **attributes: Value) -> Element:
    """A part; numbers have twelve digits, without rounding noise. None is left out."""
    element = SubElement(parent, tag)
    for name, value in attributes.items():
        if isinstance(value, str):
            element.set(name.rstrip("_"), value)
        elif value is not None:
            numbers = value if isinstance(value, tuple) else (value,)
            element.set(name.rstrip("_"), " ".join(f"{n + 0.0:.12g}" for n in numbers))
    return element


def _span(shape: Morphology, leg: Leg) -> Point | None:
    """Limits of a swing joint that stands turned; the others have their class's."""
    swing = shape.swing_range
    return (leg.turned - swing, leg.turned + swing) if leg.turned else None


def _defaults(root: Element, shape: Morphology) -> None:
    """One class a kind of part, so that the body below shows only what differs."""
    default = _add(_add(root, "default"), "default", class_="robot")
    # Robots touch floor and walls, never themselves: legs clear each other in range.
    _add(default, "geom", contype="0", conaffinity="1", rgba=INK)
    swing, inertia = (-shape.swing_range, shape.swing_range), shape.armature
    kp, kv = shape.stiffness, shape.damping
    for kind, axis, span in (
        ("swing", "0 0 1", swing),
        ("lift", "0 -1 0", shape.lift_range),
    ):
        part = _add(default, "default", class_=kind)
        _add(part, "joint", axis=axis, range=span, limited="true", armature=inertia)
        _add(part, "position", kp=kp, kv=kv, ctrlrange=span)
    for kind, form, radius in (
        ("link", "capsule", shape.leg_radius),
        ("foot", "sphere", shape.foot_radius),
    ):
        part = _add(default, "default", class_=kind)
        _add(part, "geom", type=form, size=radius)


def _torso(world: Element, shape: Morphology) -> Element:
    """The body plate, a nose that shows where the front is, and the cameras."""
    pos = (0, 0, shape.hip_height)
    torso = _add(world, "body", name="torso", childclass="robot", pos=pos)
    _add(torso, "freejoint", name="root")
    length, width, thickness = shape.plate
    raised = shape.hip_radius + thickness
    plate = {"pos": (0, 0, raised), "size": shape.plate}
    _add(torso, "geom", **plate, name="plate", type="box", mass=shape.body_mass)
    nose: dict[str, Value] = {
        "pos": (0.85 * length, 0, raised + 2 * thickness),
        "size": (0.15 * length, 0.35 * width, thickness),
        "rgba": ACCENT,
        "conaffinity": "0",
    }
    _add(torso, "geom", **nose, name="nose", type="box", mass="0")
    far = 4 * max(abs(c) for leg in shape.legs.values() for c in leg.foot)
    for name, place, axes in (
        ("top", (0, 0, 1), "0 -1 0 1 0 0"),
        ("side", (0, -1, 0.3), "1 0 0 0 0.29 0.957"),
        ("chase", (-0.7, -0.5, 0.6), "0.58 -0.81 0 0.46 0.33 0.82"),
    ):
        pose: dict[str, Value] = {"pos": tuple(far * p for p in place), "xyaxes": axes}
        _add(torso, "camera", **pose, name=name, mode="trackcom", fovy="40")
    return torso


def _leg(torso: Element, shape: Morphology, number: int, leg: Leg, colour: str) -> None:
    """A leg along its own x axis: the swing axis vertical, the lift axis horizontal."""
    cos, sin = leg.direction
    axes, pos = (cos, sin, 0, -sin, cos, 0), (*leg.hip, 0)
    body = _add(torso, "body", name=f"leg_{number}", pos=pos, xyaxes=axes)
    _add(body, "joint", class_="swing", range=_span(shape, leg), name=f"swing_{number}")
    _add(body, "joint", class_="lift", name=f"lift_{number}")
    hip = f"hip_{number}"
    _add(body, "geom", type="sphere", size=shape.hip_radius, mass="0", name=hip)
    knee = (0.55 * leg.length, 0, 0.35 * shape.hip_height)
    foot = (leg.length, 0, shape.foot_radius - shape.hip_height)
    parts: tuple[tuple[str, dict[str, Value], float], ...] = (
        ("femur", {"class_": "link", "fromto": (0, 0, 0, *knee)}, 0.45),
        ("tibia", {"class_": "link", "fromto": (*knee, *foot)}, 0.35),
        ("foot", {"class_": "foot", "pos": foot}, 0.2),
    )
    for name, own, share in parts:
        mass = share * shape.leg_mass
        _add(body, "geom", **own, rgba=colour, name=f"{name}_{number}", mass=mass)
