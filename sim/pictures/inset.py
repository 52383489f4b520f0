"""The inset of a film: the error of the body's position, magnified, with its scale.

The error is turned with the picture, so that right in the inset is right in the film.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import WIDTH, Camera
from sim.pictures.panel import EDGE, PAD, SMALL, Draw, Panel, empty, millimetres, text
from sim.runs.run import Run

TOP, BOX, WORDS = 38, 128, 116  # title, plot, and words beside it [pixels]
SIZE = (2 * PAD + BOX + 12 + WORDS, TOP + BOX + 12)
MIDDLE = np.array([PAD + BOX / 2, TOP + BOX / 2])  # of the plot: no error
DOT, CROSS = 4, 5  # of the present error, and of no error [pixels]
TRAIL_STEP = 1.0  # between points of a trail [pixels]
FILL = 0.92  # of half the plot, at most, for the largest error

NOTHING = 1e-9  # [m], below which an error is rounding
DIGITS = np.array([1.0, 2.0, 5.0])


@dataclass(frozen=True)
class Trail:
    """The departure from one prediction in the course of a walk."""

    name: str
    colour: Colour
    error: Array  # to the right and up in the picture, (T, 2) [m]
    scale: float  # pixels to a metre

    @cached_property
    def rows(self) -> Array:
        """Rows at which the trail has come another step farther."""
        return spaced_rows(self.error, TRAIL_STEP / self.scale)

    @cached_property
    def points(self) -> list[tuple[float, float]]:
        """Where those are in the panel."""
        return [self.place(row) for row in self.rows]

    def place(self, row: int) -> tuple[float, float]:
        """Where the error of a row is in the panel [pixels]."""
        x, y = MIDDLE + self.error[row] * self.scale * (1, -1)
        return float(x), float(y)

    def put(self, draw: Draw, row: int, line: int) -> None:
        """Draw the trail up to a row, its end as a dot, and its length in words."""
        past = self.points[: int(np.searchsorted(self.rows, row, side="right"))]
        x, y = self.place(row)
        draw.line([*past, (x, y)], self.colour.tint(0.6), 1)
        draw.ellipse((x - DOT, y - DOT, x + DOT, y + DOT), self.colour)
        size = millimetres(float(np.hypot(*self.error[row])), digits=2)
        text(draw, (SIZE[0] - PAD, line + 18), size, SMALL, "ra")


def inset(walk: Run, view: Camera, top: int, bottom: int, clear: int) -> Panel:
    """The panel under the key, which ends at `top`, and above the bar at `bottom`.

    Where the key is too long, it lies at the right, above `clear` [pixels].
    """
    errors = {n: _turned(walk, view, poses) for n, poses in walk.drawn.items()}
    largest = max(float(np.hypot(*error.T).max()) for error in errors.values())
    floor = 1 / (view.pixel * view.distance)  # pixels to a metre, about
    factor = magnification(largest, BOX / 2 * FILL / floor)
    scale = factor * floor
    trails = [
        Trail(name.replace("_", "-"), palette.PREDICTED[name].colour, error, scale)
        for name, error in errors.items()
    ]
    still, draw = empty(*SIZE)
    text(draw, (PAD, 10), f"error of position, {factor:g}x")
    _draw_scale(draw, scale)
    lines = [TOP + 46 * i for i in range(len(trails))]
    for line, trail in zip(lines, trails, strict=True):
        x = SIZE[0] - PAD - WORDS
        draw.ellipse((x, line + 5, x + 2 * DOT, line + 5 + 2 * DOT), trail.colour)
        text(draw, (SIZE[0] - PAD, line), trail.name, anchor="ra")

    def write(draw: Draw, row: int) -> None:
        for line, trail in zip(lines, trails, strict=True):
            trail.put(draw, row, line)

    fits = top + EDGE // 2 + SIZE[1] <= bottom
    place = (EDGE, bottom) if fits else (WIDTH - EDGE - SIZE[0], clear)
    return Panel(place[0], place[1] - SIZE[1], still, write)


def magnification(largest: float, room: float) -> float:
    """The greatest round factor with which a length [m] fits into a room [m]."""
    return _greatest_round(room / max(largest, NOTHING))


def _greatest_round(most: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten that is not above a number."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(power * DIGITS[power * DIGITS <= most * (1 + 1e-9)].max())


def _turned(walk: Run, view: Camera, poses: Array) -> Array:
    """Departure of the body, to the right and away in the picture, (T, 2) [m]."""
    angle = np.radians(view.azimuth.mean())
    right, away = (np.sin(angle), -np.cos(angle)), (np.cos(angle), np.sin(angle))
    departure = np.nan_to_num((walk.achieved - poses)[:, :2])
    return departure @ np.transpose([right, away])


def _draw_scale(draw: Draw, scale: float) -> None:
    """A cross where there is no error, and a ring at a round distance from it."""
    (x, y), ring = MIDDLE, _greatest_round(BOX / 2 * FILL / scale)
    radius = ring * scale
    draw.rectangle((PAD, TOP, PAD + BOX, TOP + BOX), None, palette.GRID, 1)
    around = (x - radius, y - radius, x + radius, y + radius)
    draw.ellipse(around, None, palette.FAINT, 1)
    draw.line((x - CROSS, y, x + CROSS, y), palette.FAINT, 1)
    draw.line((x, y - CROSS, x, y + CROSS), palette.FAINT, 1)
    at, words = (SIZE[0] - PAD, TOP + BOX - 18), f"ring {1000 * ring:g} mm"
    text(draw, at, words, anchor="ra", colour=palette.FAINT)
