"""Captions of a film: key, clock, stratum, contacts, margin, error and scales.

They stand on panels, whose constant parts are drawn once, the others on every picture.
"""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.pictures import style
from sim.pictures.camera import Camera
from sim.pictures.clock import Clock
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.inset import inset
from sim.pictures.legend import legend
from sim.pictures.panel import (
    EDGE,
    LARGE,
    MIDDLE,
    PAD,
    Draw,
    Panel,
    empty,
    millimetres,
    text,
)
from sim.pictures.scale_bar import scale_bar
from sim.pictures.stratum_caption import describe
from sim.pictures.style import HEIGHT, WIDTH

GAP = 10  # between panels [pixels]
BAR = 92  # height of the bar at the bottom [pixels]
LAMP = 11  # radius of a foot's lamp [pixels]
COLUMN = 230  # width of a number in the bar [pixels]


class Captions:
    """Writes on the pictures of one film."""

    def __init__(self, walk: FilmedWalk, clock: Clock, view: Camera) -> None:
        bottom = HEIGHT - EDGE - BAR - GAP
        key, scale = legend(walk), scale_bar(view, walk.reach, bottom)
        error = inset(walk, view, key.bottom, bottom, clear=scale.top - GAP)
        time = _clock(walk, clock.playback)
        self._panels = (key, time, scale, error, _bar(walk))

    def write(self, picture: Array, row: int) -> None:
        """Write on the picture of a row, shape (HEIGHT, WIDTH, 3), bytes, in place."""
        for panel in self._panels:
            panel.put(picture, row)


def _clock(walk: FilmedWalk, playback: float) -> Panel:
    """Top right: the time, and how much faster it passes."""
    still, draw = empty(150, 82)
    speed = "real time" if playback == 1 else f"{playback:g}x real time"
    text(draw, (150 - PAD, 48), speed, anchor="ra", colour=style.FAINT)

    def write(draw: Draw, row: int) -> None:
        text(draw, (150 - PAD, 10), f"{walk.time[row]:.1f} s", LARGE, "ra")

    return Panel(WIDTH - EDGE - 150, EDGE, still, write)


def _bar(walk: FilmedWalk) -> Panel:
    """At the bottom: stratum, feet in contact, and present measurements."""
    width, height = WIDTH - 2 * EDGE, BAR
    still, draw = empty(width, height)
    off = np.hypot(*(walk.achieved - walk.ideal)[:, :2].T)
    numbers = {"stability margin": walk.margin, "off the ideal prediction": off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    ends = [width - PAD - i * COLUMN for i in range(len(numbers))]
    for end, label in zip(ends, numbers, strict=True):
        text(draw, (end, 54), label, anchor="ra", colour=style.FAINT)

    def write(draw: Draw, row: int) -> None:
        flow = walk.flows[walk.phase[row]]
        words = describe(flow, walk.groups, walk.legs_per_group)
        text(draw, (PAD, 12), words, MIDDLE)
        for foot in range(len(walk.group_of_foot)):
            _lamp(draw, walk, row, foot, y=height - PAD - LAMP)
        for end, metres in zip(ends, numbers.values(), strict=True):
            text(draw, (end, 14), millimetres(metres[row]), LARGE, "ra")

    return Panel(EDGE, HEIGHT - EDGE - height, still, write)


def _lamp(draw: Draw, walk: FilmedWalk, row: int, foot: int, y: int) -> None:
    """A numbered disc, filled while the foot touches the floor."""
    x = PAD + LAMP + 3 * LAMP * foot
    colour = style.group(walk.group_of_foot[foot])
    touches = walk.contact[row, foot]
    place = (x - LAMP, y - LAMP, x + LAMP, y + LAMP)
    draw.ellipse(place, fill=colour if touches else None, outline=colour, width=2)
    number = str(sorted(walk.card.legs)[foot])
    text(draw, (x, y), number, 14, "mm", (255, 255, 255) if touches else colour)
