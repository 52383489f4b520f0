"""The inset of a film: errors of the body's position, each magnified, with its scale.

Every prediction has a plot and a magnification of its own, so that a small error is
seen beside a large one. Errors are turned with the picture: right is right in the film.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import Camera
from sim.pictures.panel import EDGE, PAD, SMALL, Draw, Panel, empty, millimetres, text
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

TOP, BOX, GAP = 60, 128, 16  # words above a plot, its side, the next [pixels]
PLOTS = 2
SIZE = (2 * PAD + PLOTS * BOX + GAP, TOP + BOX + 28)
DOT, CROSS = 4, 5  # of the present error, and of no error [pixels]
TRAIL_STEP = 1.0  # between points of a trail [pixels]
FILL = 0.92  # of half the plot, at most, for the largest error

NOTHING = 1e-9  # [m], below which an error is rounding
DIGITS = np.array([1.0, 2.0, 5.0])


@dataclass(frozen=True)
class Trail:
    """The departure from one prediction in the course of a walk, and its plot."""

    colour: Colour
    error: Array  # to the right and up in the picture, (T, 2) [m]
    scale: float  # pixels to a metre
    left: int  # of the plot [pixels]

    @cached_property
    def middle(self) -> Array:
        """Where there is no error [pixels]."""
        return np.array([self.left + BOX / 2, TOP + BOX / 2])

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
        x, y = self.middle + self.error[row] * self.scale * (1, -1)
        return float(x), float(y)

    def put(self, draw: Draw, row: int) -> None:
        """Draw the trail up to a row, its end as a dot, and its length in words."""
        past = self.points[: int(np.searchsorted(self.rows, row, side="right"))]
        x, y = self.place(row)
        draw.line([*past, (x, y)], self.colour.tint(0.6), 1)
        draw.ellipse((x - DOT, y - DOT, x + DOT, y + DOT), self.colour)
        size = millimetres(float(np.hypot(*self.error[row])), digits=2)
        text(draw, (self.left + BOX, TOP + BOX + 4), size, SMALL, "ra")

    def draw_scale(self, draw: Draw) -> None:
        """A cross where there is no error, and a ring at a round distance from it."""
        (x, y), ring = self.middle, _greatest_round(BOX / 2 * FILL / self.scale)
        left, radius = self.left, ring * self.scale
        draw.rectangle((left, TOP, left + BOX, TOP + BOX), None, palette.GRID, 1)
        around = (x - radius, y - radius, x + radius, y + radius)
        draw.ellipse(around, None, palette.FAINT, 1)
        draw.line((x - CROSS, y, x + CROSS, y), palette.FAINT, 1)
        draw.line((x, y - CROSS, x, y + CROSS), palette.FAINT, 1)
        words = f"ring {1000 * ring:g}"
        text(draw, (left, TOP + BOX + 4), words, colour=palette.FAINT)


def inset(walk: Run, view: Camera, top: int) -> Panel:
    """The panel of errors, whose upper edge is at `top` [pixels]."""
    floor = 1 / (view.pixel * view.distance)  # pixels to a metre, about
    still, draw = empty(*SIZE)
    text(draw, (PAD, 8), "error of the body's position", colour=palette.FAINT)
    trails = []
    for i, (name, poses) in enumerate([*walk.drawn.items()][:PLOTS]):
        error, left = _turned(walk, view, poses), PAD + i * (BOX + GAP)
        largest = float(np.hypot(*error.T).max())
        factor = magnification(largest, BOX / 2 * FILL / floor)
        trail = Trail(palette.PREDICTED[name].colour, error, factor * floor, left)
        label = PREDICTIONS[name].label if name in PREDICTIONS else name
        words = f"{label}, {factor:g}x"
        text(draw, (left, 32), words, colour=trail.colour)
        trail.draw_scale(draw)
        trails.append(trail)

    def write(draw: Draw, row: int) -> None:
        for trail in trails:
            trail.put(draw, row)

    return Panel(EDGE, top, still, write)


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
