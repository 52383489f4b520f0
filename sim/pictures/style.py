"""The style of films: size, speed, colours, and two levels of quality."""

from __future__ import annotations

from dataclasses import dataclass

Colour = tuple[int, int, int]  # red, green, blue of 255

WIDTH, HEIGHT = 1280, 720  # [pixels]; even, as the codec demands
FRAME_RATE = 25  # [1/s]
LONGEST = 40.0  # [s], unless a scenario sets the playback speed itself
TAIL = 1.5  # [s] that the last picture stays


@dataclass(frozen=True, slots=True)
class Look:
    """The quality of a film's pictures."""

    shadows: bool
    samples: int  # of every pixel, against jagged edges
    slices: int  # of round shapes


LOOKS = {
    "draft": Look(shadows=False, samples=0, slices=14),
    "final": Look(shadows=True, samples=4, slices=28),
}

PAPER: Colour = (246, 247, 249)
GRID: Colour = (221, 225, 230)
RELIEF: Colour = (196, 180, 150)
TEXT: Colour = (33, 41, 54)
FAINT: Colour = (108, 117, 130)

NOMINAL: Colour = (120, 128, 140)
PREDICTED: tuple[Colour, ...] = ((245, 178, 72), (161, 112, 206))
ACHIEVED: Colour = (18, 130, 104)
WEIGHT: Colour = (33, 41, 54)
OUTLINE: Colour = (86, 98, 116)
SWEPT: Colour = (222, 230, 240)
OBSTACLE: Colour = (115, 122, 135)
STABLE: Colour = (74, 178, 122)
TIPPING: Colour = (222, 62, 62)

# The first two are those of the shipped robots' legs.
GROUPS: tuple[Colour, ...] = (
    (41, 112, 191),
    (204, 69, 61),
    (214, 160, 36),
    (124, 92, 182),
    (64, 158, 168),
    (196, 104, 160),
)


def group(index: int) -> Colour:
    """Colour of a group of legs; after the last one they begin again."""
    return GROUPS[index % len(GROUPS)]


def footprint(index: int) -> Colour:
    """A group's colour, paler than its legs."""
    return tint(group(index), 0.6)


def tint(colour: Colour, strength: float) -> Colour:
    """The colour mixed with the floor's, for marks in the background."""
    r, g, b = (
        round(strength * c + (1 - strength) * p)
        for c, p in zip(colour, PAPER, strict=True)
    )
    return r, g, b


def rgba(colour: Colour, alpha: float = 1.0) -> tuple[float, float, float, float]:
    """The colour as MuJoCo wants it."""
    r, g, b = colour
    return r / 255, g / 255, b / 255, alpha
