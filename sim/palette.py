"""Colours and marks, which mean the same in films, viewer, replay, report and figures.

No two meanings share a colour, and those that meet in one picture also differ for
readers without red, green or blue cones. Where lines may be printed in grey, dashes
tell them apart too.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from planner.support import shipped_tables

Style = dict[str, Any]  # of a line, as matplotlib takes it


class Colour(NamedTuple):
    """A colour of the sRGB space, each component from 0 to 255."""

    red: int
    green: int
    blue: int

    @property
    def hex(self) -> str:
        """The colour as pages and matplotlib take it, such as `#2970bf`."""
        return "#{:02x}{:02x}{:02x}".format(*self)

    def rgba(self, alpha: float = 1.0) -> tuple[float, float, float, float]:
        """The colour as MuJoCo takes it."""
        return self.red / 255, self.green / 255, self.blue / 255, alpha

    @property
    def ink(self) -> "Colour":
        """Colour of words on it: white, or that of text."""
        return WHITE if 0.2 * self.red + 0.7 * self.green < 100 else TEXT

    def tint(self, strength: float) -> "Colour":
        """The colour mixed with the paper's, for marks in the background."""
        share, pairs = 1 - strength, zip(self, PAPER, strict=True)
        return Colour(*(round((1 - share) * a + share * b) for a, b in pairs))


WHITE = Colour(255, 255, 255)
PAPER = Colour(246, 247, 249)
GRID = Colour(218, 222, 227)
RELIEF = Colour(203, 212, 143)  # contour lines of a floor that is not plane
TEXT = Colour(20, 24, 32)
FAINT = Colour(100, 108, 120)  # text of less weight

CENTRE_OF_MASS = TEXT
OUTLINE = Colour(150, 158, 170)  # of the robot, from above
SWEPT = Colour(194, 231, 255)  # floor that the robot has stood over
OBSTACLE = Colour(115, 122, 135)
STABLE = Colour(88, 205, 95)  # support polygon with the weight over it
LIMIT = Colour(148, 11, 49)  # exceeded: about to tip over, touching, not as planned


@dataclass(frozen=True, slots=True)
class PathMark:
    """How the path of one kind is drawn."""

    label: str  # in keys
    colour: Colour
    width: float  # on the floor, in units of the robot's reach
    points: float  # width in print [1/72 in]
    dashes: tuple[float, ...] = ()  # of dash and gap in print, in widths of the line

    def line(self, **changes: Any) -> Style:
        """The line as matplotlib takes it, with changes."""
        dashes = (0.0, self.dashes) if self.dashes else "-"
        style = {"color": self.colour.hex, "linewidth": self.points}
        return {**style, "linestyle": dashes, **changes}


STYLES = shipped_tables("sim", "styles.toml")
GROUPS, OUTCOMES, RUNS = (
    tuple(Colour(*bytes.fromhex(code)) for code in STYLES["colours"][name])
    for name in ("groups", "outcomes", "runs")
)
NOMINAL = PathMark("nominal path", Colour(84, 88, 98), 0.01, 1.2, (3.7, 1.6))
ACHIEVED = PathMark("achieved path", Colour(0, 128, 98), 0.008, 2.2)
THOUGHT = PathMark("estimated pose", Colour(15, 0, 225), 0.004, 0.7)
PREDICTED: Mapping[str, PathMark] = {
    key: PathMark(name, Colour(*colour), wide, points, tuple(dashes))
    for key, (name, colour, wide, points, dashes) in STYLES["paths"].items()
}

# Sizes on the floor, in units of the robot's reach.
FOOTPRINT, SPOT, GOAL = 0.014, 0.032, 0.06  # radii; a spot is the centre of mass
EDGE = 0.01  # width of the edges of support polygon and outline
GHOST, GHOST_TORSO = 0.5, 0.12  # opacity of a predicted robot's legs and torso


def style_of(drawings: str) -> dict[Any, Any]:
    """Settings of matplotlib for drawings in `figures` or on `pages`."""
    return {"grid.color": GRID.hex, **STYLES["base"], **STYLES[drawings]}


def group(index: int) -> Colour:
    """Colour of a group of legs; after the last one they begin again."""
    return GROUPS[index % len(GROUPS)]


def footprint(index: int) -> Colour:
    """Colour of a group's footprints, paler than its legs."""
    return group(index).tint(0.58)
