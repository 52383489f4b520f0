"""Captions of a film: title, legend, clock, stratum, contacts and stability margin.

There are three panels. Their constant parts are drawn once, the others on every
picture.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from planner import Array
from sim.pictures import style
from sim.pictures.clock import Clock
from sim.pictures.story import FilmedWalk
from sim.pictures.style import HEIGHT, WIDTH, Colour
from sim.pictures.words import describe, noun

Draw = ImageDraw.ImageDraw

EDGE, PAD, ROUND = 20, 16, 12  # around panels, inside them, of their corners [pixels]
PANEL = (255, 255, 255, 205)
LARGE, MIDDLE, SMALL = 28, 22, 16  # type [pixels]
LINE, SWATCH = 25, 34  # height of a line of the legend, width of its sample [pixels]
LAMP = 11  # radius of a foot's lamp [pixels]
COLUMN = 230  # width of a number in the bar [pixels]


@dataclass(frozen=True)
class Panel:
    """A rectangle of the picture with words on it."""

    left: int
    top: int
    still: Image.Image  # what is always there, with transparency
    write: Callable[[Draw, int], None]  # adds what belongs to a row

    def put(self, picture: Array, row: int) -> None:
        """Lay the panel over the picture, in place."""
        width, height = self.still.size
        area = picture[self.top : self.top + height, self.left : self.left + width]
        image = Image.fromarray(area)
        image.paste(self.still, mask=self.still)
        self.write(ImageDraw.Draw(image), row)
        area[:] = np.asarray(image)


class Captions:
    """Writes on the pictures of one film."""

    def __init__(self, walk: FilmedWalk, clock: Clock) -> None:
        self._panels = (_legend(walk), _clock(walk, clock.playback), _bar(walk))

    def write(self, picture: Array, row: int) -> None:
        """Write on the picture of a row, shape (HEIGHT, WIDTH, 3), bytes, in place."""
        for panel in self._panels:
            panel.put(picture, row)


def _legend(walk: FilmedWalk) -> Panel:
    """Top left: the walk, and the meaning of the colours."""
    scenario, entries = walk.scenario, _entries(walk)
    robot = Path(scenario.robot).stem  # of a user's own, the file
    about = f"{robot}, {scenario.fields} fields, {walk.segments} segments"
    labels = [_length(label) + SWATCH for label, _, _ in entries]
    still, draw = _empty(
        max(_length(about), _length(scenario.name, LARGE), *labels) + 2 * PAD,
        84 + LINE * len(entries),
    )
    _text(draw, (PAD, 10), scenario.name, LARGE)
    _text(draw, (PAD, 46), about, colour=style.FAINT)
    for i, (label, colour, sample) in enumerate(entries):
        y = 86 + i * LINE
        sample(draw, y, colour)
        _text(draw, (PAD + SWATCH, y), label, anchor="lm")
    return Panel(EDGE, EDGE, still, lambda draw, row: None)


def _clock(walk: FilmedWalk, playback: float) -> Panel:
    """Top right: the time, and how much faster it passes."""
    still, draw = _empty(150, 82)
    speed = "real time" if playback == 1 else f"{playback:g}x real time"
    _text(draw, (150 - PAD, 48), speed, anchor="ra", colour=style.FAINT)

    def write(draw: Draw, row: int) -> None:
        _text(draw, (150 - PAD, 10), f"{walk.time[row]:.1f} s", LARGE, "ra")

    return Panel(WIDTH - EDGE - 150, EDGE, still, write)


def _bar(walk: FilmedWalk) -> Panel:
    """At the bottom: stratum, feet in contact, and present measurements."""
    width, height = WIDTH - 2 * EDGE, 92
    still, draw = _empty(width, height)
    off = np.hypot(*(walk.achieved - walk.ideal)[:, :2].T)
    numbers = {"stability margin": walk.margin, "off the ideal prediction": off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    ends = [width - PAD - i * COLUMN for i in range(len(numbers))]
    for end, label in zip(ends, numbers, strict=True):
        _text(draw, (end, 54), label, anchor="ra", colour=style.FAINT)

    def write(draw: Draw, row: int) -> None:
        flow = walk.flows[walk.phase[row]]
        words = describe(flow, walk.groups, walk.legs_per_group)
        _text(draw, (PAD, 12), words, MIDDLE)
        for foot in range(len(walk.group_of_foot)):
            _lamp(draw, walk, row, foot, y=height - PAD - LAMP)
        for end, metres in zip(ends, numbers.values(), strict=True):
            _text(draw, (end, 14), _millimetres(metres[row]), LARGE, "ra")

    return Panel(EDGE, HEIGHT - EDGE - height, still, write)


def _lamp(draw: Draw, walk: FilmedWalk, row: int, foot: int, y: int) -> None:
    """A numbered disc, filled while the foot touches the floor."""
    x = PAD + LAMP + 3 * LAMP * foot
    colour = style.group(walk.group_of_foot[foot])
    touches = walk.contact[row, foot]
    place = (x - LAMP, y - LAMP, x + LAMP, y + LAMP)
    draw.ellipse(place, fill=colour if touches else None, outline=colour, width=2)
    number = str(sorted(walk.card.legs)[foot])
    _text(draw, (x, y), number, 14, "mm", (255, 255, 255) if touches else colour)


Sample = Callable[[Draw, int, Colour], None]


def _entries(walk: FilmedWalk) -> list[tuple[str, Colour, Sample]]:
    """Label, colour and sample of every line of the legend."""
    groups = noun(walk.legs_per_group)
    around: list[tuple[str, Colour, Sample]] = [
        ("obstacles", style.OBSTACLE, _block),
        ("floor swept over", style.SWEPT, _block),
    ]
    return [
        *(around if walk.scenario.obstacles else []),
        ("outline of the robot", style.OUTLINE, _line),
        ("nominal path", style.NOMINAL, _dashes),
        *((name, style.PREDICTED[i], _line) for i, name in enumerate(walk.predicted)),
        ("achieved path", style.ACHIEVED, _line),
        ("centre of mass", style.WEIGHT, _disc),
        ("support polygon", style.STABLE, _area),
        *(
            (f"footprints of {groups} {group}", style.footprint(i), _disc)
            for i, group in enumerate(walk.groups)
        ),
    ]


def _line(draw: Draw, y: int, colour: Colour) -> None:
    draw.line((PAD, y, PAD + 24, y), colour, 4)


def _dashes(draw: Draw, y: int, colour: Colour) -> None:
    for x in range(PAD, PAD + 24, 9):
        draw.line((x, y, x + 6, y), colour, 4)


def _disc(draw: Draw, y: int, colour: Colour) -> None:
    draw.ellipse((PAD + 5, y - 7, PAD + 19, y + 7), fill=colour)


def _block(draw: Draw, y: int, colour: Colour) -> None:
    draw.rectangle((PAD, y - 7, PAD + 24, y + 7), colour)


def _area(draw: Draw, y: int, colour: Colour) -> None:
    draw.rectangle((PAD, y - 7, PAD + 24, y + 7), (*colour, 90), colour, 2)


def _empty(width: int, height: int) -> tuple[Image.Image, Draw]:
    """An empty panel and a drawing context for it."""
    still = Image.new("RGBA", (width, height))
    draw = ImageDraw.Draw(still)
    draw.rounded_rectangle((0, 0, width - 1, height - 1), ROUND, PANEL)
    return still, draw


def _text(
    draw: Draw,
    at: tuple[int, int],
    words: str,
    size: int = SMALL,
    anchor: str = "la",
    colour: Colour = style.TEXT,
) -> None:
    draw.text(at, words, colour, _font(size), anchor)


def _length(words: str, size: int = SMALL) -> int:
    return int(_font(size).getlength(words))


def _millimetres(metres: float) -> str:
    return f"{1000 * metres:.1f} mm" if np.isfinite(metres) else "none"


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
