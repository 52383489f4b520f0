"""The grid on the floor, whose lines have the same width everywhere in the picture.

The lines are a drawing. Without a graphics card, a texture would take as much time
as the rest of the picture.
"""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.pictures import style
from sim.pictures.camera import Camera
from sim.pictures.floor_drawing import Drawing, join, polygons
from sim.pictures.marks import Mark

CELLS = 0.5  # of the grid, about [reach of the robot]
WIDTH = 1.8  # of a line [pixels]
PIECES = 12  # that a line consists of, each with a width of its own
FRAMES = 9  # at which it is asked how far away a line is
ROUND = (1.0, 2.0, 5.0, 10.0)


def cell(reach: float) -> float:
    """Side of a cell of the grid, a round length [m].

    Args:
        reach: Of the robot [m].
    """
    power = 10.0 ** np.floor(np.log10(CELLS * reach))
    return float(power * min(ROUND, key=lambda r: abs(r - CELLS * reach / power)))


def grid(view: Camera, reach: float) -> Mark:
    """Lines along x and y on all of the floor that a film will show.

    Args:
        view: Where the film is taken from.
        reach: Of the robot [m].
    """
    side, low, high = cell(reach), *view.floor_seen()
    first, last = np.floor(low / side), np.ceil(high / side)
    eyes = view.eyes()[:: max(1, len(view.azimuth) // FRAMES)]
    lines = [
        _line(axis, side * at, side * first, side * last, eyes, view.pixel)
        for axis in (0, 1)
        for at in np.arange(first[axis], last[axis] + 1)
    ]
    return Mark("grid", join(lines), style.GRID)


def _line(
    axis: int, at: float, low: Array, high: Array, eyes: Array, pixel: float
) -> Drawing:
    """A line on which one coordinate is constant, wider where it is farther away.

    Args:
        axis: The coordinate that is constant.
        at: Its value [m].
        low: Where the other one begins, shape (2,) [m].
        high: Where it ends, shape (2,) [m].
        eyes: Places of the camera, shape (n, 3) [m].
        pixel: Width of a pixel at a distance of one [m].
    """
    along = np.linspace(low[1 - axis], high[1 - axis], PIECES + 1)
    points = np.zeros((PIECES + 1, 3))
    points[:, axis], points[:, 1 - axis] = at, along
    away = np.linalg.norm(points[:, None] - eyes, axis=-1).min(axis=1)
    half = np.zeros((PIECES + 1, 2))
    half[:, axis] = WIDTH * pixel * away / 2 * (1 if axis else -1)
    left, right = points[:, :2] + half, points[:, :2] - half
    corners = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    return polygons(corners, [0] * PIECES)
