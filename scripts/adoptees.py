"""Ten robots as others draw them, to be adopted: python -m scripts.adoptees spider."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from planner.support import shipped_tables

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


FILE = shipped_tables("scripts", "adoptees.toml")
HIPS = {name: tuple(map(tuple, hips)) for name, hips in FILE["hips"].items()}
HIPS |= {"radial 6": radial(6), "radial 8": radial(8), "parallel 6": parallel(6)}
ADOPTEES = tuple(
    Adoptee(name, **robot | {"hips": HIPS[robot["hips"]]})
    for name, robot in FILE["robots"].items()
)
TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent),
    trim_blocks=True,
    lstrip_blocks=True,
    undefined=StrictUndefined,
)
TEMPLATES.filters |= {"g": "{:.6g}".format, "fixed": "{:.9f}".format}
TEMPLATES.globals |= {**FILE["lengths"], "DRIVES": FILE["drives"]}
TEMPLATES.globals |= {"cos": cos, "sin": sin}


if __name__ == "__main__":
    for adoptee in ADOPTEES:
        if adoptee.name in sys.argv[1:]:
            print(adoptee.write(Path()))
