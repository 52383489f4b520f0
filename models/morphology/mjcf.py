"""Dimensions of a robot whose legs have two joints, and the MJCF written from them.

Body frame: x forward, y left, z up, origin at the height of the hips above the point
where x = y = 0. SI units, radians. `robot.xml.jinja` is meant to be read by people, as
are the files: axes instead of quaternions, one default class for each kind of part.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import atan2, cos, hypot, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Template

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
        legs[number] = Leg(hip, foot, atan2(sin(along - bearing), cos(along - bearing)))
    return legs


COLOURS = (  # of the groups; pictures mark their footprints alike
    *("0.16 0.44 0.75 1", "0.80 0.27 0.24 1", "0.87 0.82 0.20 1"),
    *("0.98 0.67 0.63 1", "0.44 0.56 0.69 1", "0.44 0.31 0.03 1"),
)


def write_mjcf(shape: Morphology, groups: Sequence[Collection[int]]) -> str:
    """MJCF of the robot on the floor of `scene.xml`, one colour a group of legs."""
    of = [COLOURS[number % len(COLOURS)] for number in range(len(groups))]
    colours = {leg: of[number] for number, legs in enumerate(groups) for leg in legs}
    angles = [angle for leg in shape.legs.values() for angle in (leg.turned, 0)]
    far = 4 * max(abs(c) for leg in shape.legs.values() for c in leg.foot)
    template = template_of(Path(__file__).with_name("robot.xml.jinja"))
    facts = {"colours": colours, "angles": angles, "far": far, "n": _numbers}
    return template.render(shape=shape, **facts)


@cache
def template_of(path: Path) -> "Template":
    """The template in a file, which must be given all that it names."""
    from jinja2 import StrictUndefined, Template

    return Template(
        path.read_text("utf-8"), trim_blocks=True, lstrip_blocks=True,
        keep_trailing_newline=True, undefined=StrictUndefined,
    )  # fmt: skip


def _numbers(*values: float) -> str:
    """Numbers of an attribute with twelve digits, without rounding noise."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)
