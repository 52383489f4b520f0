"""The inset of a film: the error of the body's position off each prediction.

Each is magnified for itself, so that a small error is seen beside a large one, and
turned with the picture: right is right in the film.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import Camera
from sim.pictures.legend import EDGE, PAD, Draw, Panel, empty, text
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

TOP, BOX, APART = 60, 128, 16  # of the inset: words above a plot, its side, the next
PLOTS = 2
DOT, CROSS = 4, 5  # of the present error, and of no error [pixels]
RIM, TIP = 62, 13  # from the middle to what points ahead, and its length [pixels]
FILL = 0.8  # of half the plot, at most, for the largest error
DIGITS = np.array([1.0, 2.0, 5.0])


@dataclass(frozen=True)
class Trail:
    """The departure from one prediction in the course of a walk, and its plot."""

    colour: Colour
    error: Array  # to the right and up in the picture, (T, 2) [m]
    scale: float  # pixels to a metre
    left: int  # of the plot [pixels]

    @cached_property
    def rows(self) -> Array:
        """Rows at which the trail has come another pixel farther."""
        return spaced_rows(self.error, 1.0 / self.scale)

    @cached_property
    def points(self) -> list[tuple[float, float]]:
        """Where those are in the panel."""
        return [self.place(error) for error in self.error[self.rows]]

    def place(self, error: Sequence[float] | Array = (0.0, 0.0)) -> tuple[float, float]:
        """Where an error is in the panel, or where there is none [pixels]."""
        middle = (self.left + BOX / 2, TOP + BOX / 2)
        x, y = middle + np.asarray(error) * self.scale * (1, -1)
        return float(x), float(y)

    def put(self, draw: Draw, row: int) -> None:
        """Draw the trail up to a row, its end as a dot, and its length in words."""
        past = self.points[: int(np.searchsorted(self.rows, row, side="right"))]
        x, y = self.place(self.error[row])
        draw.line([*past, (x, y)], self.colour.tint(0.6), 1)
        draw.circle((x, y), DOT, self.colour)
        size = f"{1000 * np.hypot(*self.error[row]):.2f}"
        text(draw, (self.left + BOX, TOP + BOX + 4), size, anchor="ra")

    def draw_scale(self, draw: Draw) -> None:
        """A cross where there is no error, and a ring at a round distance from it."""
        (x, y), ring = self.place(), magnification(self.scale, BOX / 2 * FILL)
        left = self.left
        draw.rectangle((left, TOP, left + BOX, TOP + BOX), None, palette.GRID, 1)
        draw.circle((x, y), ring * self.scale, None, palette.FAINT, 1)
        draw.line((x - CROSS, y, x + CROSS, y), palette.FAINT, 1)
        draw.line((x, y - CROSS, x, y + CROSS), palette.FAINT, 1)
        text(draw, (left, TOP + BOX + 4), f"ring {1000 * ring:g}", colour=palette.FAINT)


def inset(walk: Run, view: Camera, top: int) -> Panel:
    """The panel of errors, whose upper edge is at `top` [pixels]."""
    floor = 1 / (view.pixel * view.distance)  # pixels to a metre, about
    still, draw = empty(2 * PAD + PLOTS * BOX + APART, TOP + BOX + 28)
    text(draw, (PAD, 8), "error of position [mm]", colour=palette.FAINT)
    text(draw, (PAD + BOX + 96, 8), "front", colour=palette.FAINT)
    _tip(draw, (PAD + BOX + 84, 11), (0.0, 1.0))
    angle = np.radians(view.azimuth.mean())
    right, away = (np.sin(angle), -np.cos(angle)), (np.cos(angle), np.sin(angle))
    ahead = np.stack([np.cos(walk.achieved[:, 2]), np.sin(walk.achieved[:, 2])], axis=1)
    ahead = ahead @ np.transpose([right, away])
    trails = []
    for i, (name, poses) in enumerate([*walk.drawn.items()][:PLOTS]):
        error = np.nan_to_num((walk.achieved - poses)[:, :2])
        error, left = error @ np.transpose([right, away]), PAD + i * (BOX + APART)
        factor = magnification(float(np.hypot(*error.T).max()), BOX / 2 * FILL / floor)
        trail = Trail(palette.PREDICTED[name].colour, error, factor * floor, left)
        label = PREDICTIONS[name].label if name in PREDICTIONS else name
        text(draw, (left, 32), f"{label}, {factor:g}x", colour=trail.colour)
        trail.draw_scale(draw)
        trails.append(trail)

    def write(draw: Draw, row: int) -> None:
        for trail in trails:
            trail.put(draw, row)
            (x, y), (along, up) = trail.place(), RIM * ahead[row]
            _tip(draw, (x + along, y - up), ahead[row])

    return Panel(EDGE, top, still, write)


def _tip(draw: Draw, at: tuple[float, float], way: Sequence[float] | Array) -> None:
    """A slender triangle that points a way, to the right and up."""
    x, y = at
    right, up = way
    back = np.array([x - TIP * right, y + TIP * up])
    across = TIP / 4 * np.array([up, right])
    draw.polygon([at, tuple(back - across), tuple(back + across)], palette.TEXT)


def magnification(largest: float, room: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten by which a size fits a room."""
    most = room / max(largest, 1e-9)  # [m], below which an error is rounding
    power = 10.0 ** np.floor(np.log10(most))
    return float(power * DIGITS[power * DIGITS <= most * (1 + 1e-9)].max())
