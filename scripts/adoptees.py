"""Ten robots in MJCF and URDF as others draw them, from templates, to be adopted.

Example:
    python -m scripts.adoptees spider
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

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
        kind = "urdf" if self.urdf else "xml"
        path = folder / f"{self.name}.{kind}"
        text = TEMPLATES.get_template(f"adoptee.{kind}.jinja").render(robot=self)
        path.write_text(text.lstrip())
        return path

    @property
    def half(self) -> tuple[float, float]:
        """Sizes of its body, which ends at its hips, in units of the size."""
        x, y, _ = zip(*self.hips, strict=True)
        return max(map(abs, x)), max(map(abs, y))


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
DRIVES = {"motor": 'gear="20" ctrlrange="-1 1"', "position": 'kp="600" kv="3"'}
TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent),
    trim_blocks=True,
    lstrip_blocks=True,
    undefined=StrictUndefined,
)
TEMPLATES.filters |= {"g": "{:.6g}".format, "fixed": "{:.9f}".format}
TEMPLATES.globals |= {"COXA": COXA, "FEMUR": FEMUR, "TIBIA": TIBIA, "RADIUS": RADIUS}
TEMPLATES.globals |= {"STEEP": STEEP, "DRIVES": DRIVES, "cos": cos, "sin": sin}


if __name__ == "__main__":
    for adoptee in ADOPTEES:
        if adoptee.name in sys.argv[1:]:
            print(adoptee.write(Path()))
