"""Ten robots in MJCF and URDF as others draw them, built to be adopted.

Their legs stick out straight or are bent, stand around the body or along it, have two
joints or three, motors, servos or nothing, names or none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

Point = tuple[float, float, float]
Hip = tuple[float, float, float]  # x, y [m] and bearing [rad] in units of the size


def radial(count: int) -> tuple[Hip, ...]:
    """Legs evenly around the body."""
    bearings = [2 * pi * (k + 0.5) / count for k in range(count)]
    return tuple((0.1 * cos(b), 0.1 * sin(b), b) for b in bearings)


def parallel(count: int, length: float = 0.24, width: float = 0.06) -> tuple[Hip, ...]:
    """Legs square to the body, half of them on each side."""
    half = count // 2
    steps = [length * (0.5 - k / (half - 1)) for k in range(half)]
    return tuple((x, side * width, side * pi / 2) for x in steps for side in (1, -1))


UNEVEN: tuple[Hip, ...] = (
    (0.13, 0.05, 0.9), (0.12, -0.06, -0.8), (0.01, 0.09, 1.6),
    (-0.01, -0.08, -1.5), (-0.12, 0.05, 2.3), (-0.13, -0.05, -2.2),
)  # fmt: skip


@dataclass(frozen=True)
class Adoptee:
    """One robot."""

    name: str  # of its file
    hips: Sequence[Hip]  # where its legs begin
    joints: int = 3  # of a leg, or 2
    straight: bool = False  # whether its knees are stretched out as it is drawn
    drive: str = ""  # what moves its joints: motor, position or nothing
    urdf: bool = False  # whether it is written as URDF
    size: float = 1.0  # factor of all lengths
    down: bool = False  # whether the axes of its swing joints point down
    bare: bool = False  # whether its geoms have no names

    def write(self, folder: Path) -> Path:
        """Write its file, and nothing else."""
        path = folder / f"{self.name}.{'urdf' if self.urdf else 'xml'}"
        path.write_text(_urdf(self) if self.urdf else _mjcf(self))
        return path


ADOPTEES = (
    Adoptee("spider", radial(6), straight=True, drive="motor"),
    Adoptee("beetle", parallel(6), drive="motor", down=True, bare=True),
    Adoptee("crab", UNEVEN, drive="position"),
    Adoptee("scorpion", radial(8), down=True),
    Adoptee("daisy", radial(6), joints=2, down=True),
    Adoptee("train", parallel(6), joints=2, bare=True),
    Adoptee("giant", UNEVEN, joints=2, size=2.0, drive="motor"),
    Adoptee("octopus", radial(8), joints=2, drive="motor"),
    Adoptee("walker", radial(6), straight=True, urdf=True),
    Adoptee("box", parallel(6), joints=2, urdf=True),
)
COXA, FEMUR, TIBIA, RADIUS = 0.03, 0.06, 0.09, 0.009  # [m] in units of the size
STEEP = 0.35  # [rad], of the femur of two-jointed legs
DRIVES = {
    "motor": '<motor joint="{}" gear="20" ctrlrange="-1 1"/>',
    "position": '<position joint="{}" kp="600" kv="3"/>',
    "": "",
}


def _mjcf(robot: Adoptee) -> str:
    s = robot.size
    legs = "".join(_mjcf_leg(robot, k, hip) for k, hip in enumerate(robot.hips, 1))
    parts = ("yaw", "pitch", "knee")[: robot.joints]
    names = [f"{part}{k + 1}" for k in range(len(robot.hips)) for part in parts]
    drives = "".join(DRIVES[robot.drive].format(name) for name in names)
    length = max(abs(x) for x, *_ in robot.hips) * s
    width = max(abs(y) for _, y, _ in robot.hips) * s
    return f"""<mujoco model="{robot.name}">
  <compiler angle="radian" autolimits="true"/>
  <default>
    <joint armature="{0.002 * s**5:.6g}" damping="0.05"/>
    <geom density="400" friction="0.9 0.005 0.0001"/>
  </default>
  <worldbody>
    <body name="trunk" pos="0 0 0.3">
      <freejoint/>
      <geom type="box" size="{length:.6g} {width:.6g} {0.02 * s:.6g}" density="700"
            contype="0" conaffinity="0"/>{legs}
    </body>
  </worldbody>
  <actuator>{drives}</actuator>
</mujoco>
"""


def _mjcf_leg(robot: Adoptee, number: int, hip: Hip) -> str:
    s = robot.size
    x, y, bearing = hip
    axis = "0 0 -1" if robot.down else "0 0 1"
    turned = f"{cos(bearing / 2):.9f} 0 0 {sin(bearing / 2):.9f}"
    coxa, femur, tibia, radius = (s * v for v in (COXA, FEMUR, TIBIA, RADIUS))
    name = "" if robot.bare else f'name="toe{number}" '
    ghost = f'type="capsule" size="{0.7 * radius:.6g}" contype="0" conaffinity="0"'
    if robot.joints == 2:
        out, up = femur * cos(STEEP), femur * sin(STEEP)
        rest = f"""
          <geom {ghost} fromto="0 0 0 {out:.6g} 0 {up:.6g}"/>
          <geom {ghost} fromto="{out:.6g} 0 {up:.6g} {out:.6g} 0 {up - tibia:.6g}"/>
          <geom {name}type="sphere" size="{radius:.6g}"
                pos="{out:.6g} 0 {up - tibia:.6g}"/>"""
    else:
        end = f"{tibia:.6g} 0 0" if robot.straight else f"0 0 {-tibia:.6g}"
        rest = f"""
          <geom {ghost} fromto="0 0 0 {femur:.6g} 0 0"/>
          <body name="shin{number}" pos="{femur:.6g} 0 0">
            <joint name="knee{number}" axis="0 1 0" range="-2.2 2.2"/>
            <geom {ghost} fromto="0 0 0 {end}"/>
            <geom {name}type="sphere" size="{radius:.6g}" pos="{end}"/>
          </body>"""
    return f"""
      <body name="hip{number}" pos="{s * x:.9f} {s * y:.9f} 0" quat="{turned}">
        <joint name="yaw{number}" axis="{axis}" range="-1.2 1.2"/>
        <geom {ghost} fromto="0 0 0 {coxa:.6g} 0 0"/>
        <body name="thigh{number}" pos="{coxa:.6g} 0 0">
          <joint name="pitch{number}" axis="0 1 0" range="-1.4 1.4"/>{rest}
        </body>
      </body>"""


def _urdf(robot: Adoptee) -> str:
    if robot.joints == 2:
        out, up = FEMUR * cos(STEEP), FEMUR * sin(STEEP)
        toe = (out, 0.0, up - TIBIA)
        rest = [("pitch", COXA, 1.4, "thigh", 0.03, (out / 2, 0.0, 0.0))]
    else:
        toe = (TIBIA, 0.0, 0.0) if robot.straight else (0.0, 0.0, -TIBIA)
        rest = [
            ("pitch", COXA, 1.4, "thigh", 0.02, (FEMUR / 2, 0.0, 0.0)),
            ("knee", FEMUR, 2.2, "shin", 0.02, (toe[0] / 2, 0.0, toe[2] / 2)),
        ]
    body = _link("trunk", 1.0, (0.0, 0.0, 0.0))
    for leg, (x, y, bearing) in enumerate(robot.hips, 1):
        place = f'xyz="{x:.9f} {y:.9f} 0" rpy="0 0 {bearing:.9f}"'
        body += _joint(f"yaw{leg}", "trunk", f"hip{leg}", place, "0 0 1", 1.2)
        body += _link(f"hip{leg}", 0.02, (COXA / 2, 0.0, 0.0))
        parent = f"hip{leg}"
        for joint, far, most, link, mass, middle in rest:
            child, place = f"{link}{leg}", f'xyz="{far} 0 0"'
            body += _joint(f"{joint}{leg}", parent, child, place, "0 1 0", most)
            body += _link(child, mass, middle, toe if joint == rest[-1][0] else None)
            parent = child
    return f'<?xml version="1.0"?>\n<robot name="{robot.name}">{body}\n</robot>\n'


def _link(name: str, mass: float, middle: Point, toe: Point | None = None) -> str:
    inertia, touch = mass * 1e-3, ""
    if toe is not None:
        touch = f"""
    <collision>
      <origin xyz="{_spaced(toe)}"/>
      <geometry><sphere radius="{RADIUS}"/></geometry>
    </collision>"""
    return f"""
  <link name="{name}">
    <inertial>
      <origin xyz="{_spaced(middle)}"/><mass value="{mass}"/>
      <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/>
    </inertial>{touch}
  </link>"""


def _spaced(point: Point) -> str:
    return " ".join(f"{value:.9f}" for value in point)


def _joint(
    name: str, parent: str, child: str, place: str, axis: str, most: float
) -> str:
    return f"""
  <joint name="{name}" type="revolute">
    <origin {place}/><axis xyz="{axis}"/>
    <parent link="{parent}"/><child link="{child}"/>
    <limit lower="-{most}" upper="{most}" effort="20" velocity="6"/>
  </joint>"""
