"""Panels of a film, light rectangles with words; and the legend, the first of them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from planner import Array
from sim import palette
from sim.palette import NOMINAL, PREDICTED, Colour
from sim.pictures.ghost import farthest_ghost, ghost_of
from sim.pictures.marks import LEVELS
from sim.runs.run import Run

Draw = ImageDraw.ImageDraw

EDGE, PAD, ROUND = 20, 16, 12  # around panels, inside them, of their corners [pixels]
COLOUR = (255, 255, 255, 205)
LARGE, MIDDLE, SMALL = 28, 22, 16  # type [pixels]
LINE, SWATCH = 25, 34  # height of a line, width of its sample [pixels]
NOSE = "nose"  # geom on the front of the shipped robots
ENTRIES, WIDE = 6, 304  # lines; width [pixels]
SEEN = 4  # beside the robot's legs, at least, of a ghost in the key [pixels]
TITLE = 86  # height of what is above the lines [pixels]
NOUNS = {1: "leg", 2: "pair", 3: "tripod", 4: "tetrapod"}  # by legs in a group


@dataclass(frozen=True)
class Panel:
    """A rectangle of the picture with words on it."""

    left: int
    top: int
    still: Image.Image  # what is always there, with transparency
    write: Callable[[Draw, int], None]  # adds what belongs to a row

    @property
    def bottom(self) -> int:
        """Where the picture below it begins [pixels]."""
        return self.top + self.still.size[1]

    def put(self, picture: Array, row: int) -> None:
        """Lay the panel over the picture, in place."""
        width, height = self.still.size
        area = picture[self.top : self.top + height, self.left : self.left + width]
        image = Image.fromarray(area)
        image.paste(self.still, mask=self.still)
        self.write(ImageDraw.Draw(image), row)
        area[:] = np.asarray(image)


def empty(width: int, height: int) -> tuple[Image.Image, Draw]:
    """An empty panel and a drawing context for it."""
    still = Image.new("RGBA", (width, height))
    draw = ImageDraw.Draw(still)
    draw.rounded_rectangle((0, 0, width - 1, height - 1), ROUND, COLOUR)
    return still, draw


def text(
    draw: Draw,
    at: tuple[int, int],
    words: str,
    size: int = SMALL,
    anchor: str = "la",
    colour: Colour = palette.TEXT,
) -> None:
    """Write words at a place, with an anchor as Pillow names it."""
    mask, (left, top) = _mask(words, size, anchor)
    draw.bitmap((at[0] + left, at[1] + top), mask, colour)


def length(words: str, size: int = SMALL) -> int:
    """Width of words [pixels]."""
    return int(_font(size).getlength(words))


def fitting(words: str, width: int, size: int = SMALL) -> str:
    """Words cut to a width [pixels]."""
    cut = words if len(words) <= width else words[:width] + "..."
    while cut and length(cut, size) > width:
        cut = cut.removesuffix("...")[:-1] + "..."
    return cut


@lru_cache(maxsize=1024)
def _mask(words: str, size: int, anchor: str) -> tuple[Image.Image, tuple[int, int]]:
    """Words as a mask, and where its corner is from their anchor; many come again."""
    left, top, right, bottom = _font(size).getbbox(words, anchor=anchor)
    left, top = int(np.floor(left)), int(np.floor(top))
    mask = Image.new("L", (int(np.ceil(right)) - left, int(np.ceil(bottom)) - top))
    ImageDraw.Draw(mask).text((-left, -top), words, 255, _font(size), anchor)
    return mask, (left, top)


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)


def legend(walk: Run, scale: float) -> Panel:
    """The panel at the top left: the walk, and the meaning of the colours.

    The scale of the picture [pixels/m] decides whether the ghost is ever seen.
    """
    scenario, lines, room = walk.scenario, _lines(walk, scale), WIDE - 2 * PAD
    way = "played" if scenario.motion else f"{scenario.fields} fields"
    about = f"{Path(scenario.robot).stem}, {way}"
    still, draw = empty(WIDE, TITLE - 2 + LINE * len(lines))
    text(draw, (PAD, 10), fitting(scenario.name, room, LARGE), LARGE)
    text(draw, (PAD, 46), fitting(about, room), colour=palette.FAINT)
    for i, (label, colour, kind) in enumerate(lines):
        y = TITLE + i * LINE
        _sample(draw, kind, y, colour)
        text(draw, (PAD + SWATCH, y), label, anchor="lm")
    return Panel(EDGE, EDGE, still, lambda draw, row: None)


def entries(walk: Run) -> list[tuple[str, Colour]]:
    """Labels and colours of what viewer and replay show."""
    paths = [palette.PREDICTED[name] for name in walk.drawn]
    path, end = walk.path_labels
    groups, front = noun(walk), nose(walk)
    return [
        *([("nose, the front", front)] if front else []),
        (path, palette.NOMINAL.colour),
        *((mark.label, mark.colour) for mark in (*paths, palette.ACHIEVED)),
        (end, palette.NOMINAL.colour),
        ("support polygon", palette.STABLE),
        ("support polygon, weight outside", palette.LIMIT),
        *(
            (f"legs of {groups} {group}; their footprints are paler", palette.group(i))
            for i, group in enumerate(walk.card.groups)
        ),
    ]


def noun(walk: Run) -> str:
    """What a group of legs is called, after how many all groups have."""
    size, *others = {len(group.legs) for group in walk.card.groups.values()}
    return "group" if others else NOUNS.get(size, "group")


def nose(walk: Run) -> Colour | None:
    """Colour of the part that shows which side of the robot is the front, if any."""
    geoms = mujoco.MjSpec.from_file(str(walk.model_file)).geoms
    for rgba in (geom.rgba for geom in geoms if geom.name == NOSE):
        return Colour(*(round(255 * part) for part in rgba[:3]))
    return None


def _lines(walk: Run, scale: float) -> list[tuple[str, Colour, str]]:
    """Label, colour and kind of sample of every line of a film's legend."""
    labels = {name: PREDICTED[name].label for name in walk.drawn}
    if scale * farthest_ghost(walk) > SEEN:
        labels[ghost_of(walk)] += ", ghost"
    around = ("floor swept over", palette.SWEPT, "block")
    thought = (palette.THOUGHT.label, palette.THOUGHT.colour, "ring")
    bumps = f"contours, {1000 * (walk.scenario.bumps / LEVELS):.3g} mm"
    lines = [
        (", ".join(walk.path_labels), NOMINAL.colour, "dashes"),
        *((label, PREDICTED[n].colour, "line") for n, label in labels.items()),
        (palette.ACHIEVED.label, palette.ACHIEVED.colour, "line"),
        ("support, centre of mass", palette.STABLE, "area"),
        *([thought] if walk.thought else []),
        *([around] if walk.scenario.obstacles else []),
        *([(bumps, palette.RELIEF, "line")] if walk.scenario.bumps else []),
        ("footprints, fading", palette.group(0).tint(0.6), "disc"),
    ]
    return lines[:ENTRIES]


def _sample(draw: Draw, kind: str, y: int, colour: Colour) -> None:
    """Draw how a meaning looks, at the left of its line."""
    left, right = PAD, PAD + 24
    match kind:
        case "line":
            draw.line((left, y, right, y), colour, 4)
        case "dashes":
            for x in range(left, right, 9):
                draw.line((x, y, x + 6, y), colour, 4)
        case "disc":
            draw.ellipse((left + 5, y - 7, left + 19, y + 7), fill=colour)
        case "ring":
            draw.ellipse((left + 4, y - 8, left + 20, y + 8), palette.PAPER, colour, 3)
        case "block":
            draw.rectangle((left, y - 7, right, y + 7), colour)
        case "area":
            draw.rectangle((left, y - 7, right, y + 7), (*colour, 90), colour, 2)
            draw.ellipse((left + 8, y - 4, left + 16, y + 4), palette.CENTRE_OF_MASS)
