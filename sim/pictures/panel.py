"""Panels of a film: light rectangles with text, part of which changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from planner import Array
from sim import palette
from sim.palette import Colour

Draw = ImageDraw.ImageDraw

EDGE, PAD, ROUND = 20, 16, 12  # around panels, inside them, of their corners [pixels]
COLOUR = (255, 255, 255, 205)
LARGE, MIDDLE, SMALL = 28, 22, 16  # type [pixels]


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
    cut = words
    while cut and length(cut, size) > width:
        cut = cut.removesuffix("...")[:-1] + "..."
    return cut


def millimetres(metres: float, digits: int = 1) -> str:
    """A length in words, with so many decimals; none where it is not finite."""
    return f"{1000 * metres:.{digits}f} mm" if np.isfinite(metres) else "none"


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
