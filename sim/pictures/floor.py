"""The grid on the floor, and the contour lines of a floor that is not plane.

The lines of the grid have the same width everywhere in the picture. They are a drawing:
without a graphics card, a texture would take as much time as the rest of the picture.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from planner import Array
from sim import palette
from sim.pictures.camera import Camera
from sim.pictures.drawing import Drawing, Mark, join, polygons, ribbon
from sim.runs.run import Run

CELLS = 0.5  # of the grid, about [reach of the robot]
LINE_WIDTH = 1.8  # of the grid [pixels]
PIECES = 12  # that a line consists of, each with a width of its own
FRAMES = 9  # at which it is asked how far away a line is
ROUND = (1.0, 2.0, 5.0, 10.0)
LEVELS = 5  # equal parts of the height that contours divide
CONTOUR_WIDTH = 0.005  # [reach of the robot]


def cell(reach: float) -> float:
    """Side of a cell of the grid for a robot's reach, a round length [m]."""
    power = 10.0 ** np.floor(np.log10(CELLS * reach))
    return float(power * min(ROUND, key=lambda r: abs(r - CELLS * reach / power)))


def grid(view: Camera, reach: float) -> Mark:
    """Lines along x and y on all of the floor that a film will show."""
    side, low, high = cell(reach), *view.floor_seen()
    first, last = np.floor(low / side), np.ceil(high / side)
    eyes = view.eyes()[:: max(1, len(view.azimuth) // FRAMES)]
    lines = [
        _line(axis, side * at, side * first, side * last, eyes, view.pixel)
        for axis in (0, 1)
        for at in np.arange(first[axis], last[axis] + 1)
    ]
    return Mark("grid", join(lines), palette.GRID)


def _line(
    axis: int, at: float, low: Array, high: Array, eyes: Array, pixel: float
) -> Drawing:
    """A line where coordinate `axis` is `at`, wider where it is farther away."""
    along = np.linspace(low[1 - axis], high[1 - axis], PIECES + 1)
    points = np.zeros((PIECES + 1, 3))
    points[:, axis], points[:, 1 - axis] = at, along
    away = np.linalg.norm(points[:, None] - eyes, axis=-1).min(axis=1)
    half = np.zeros((PIECES + 1, 2))
    half[:, axis] = LINE_WIDTH * pixel * away / 2 * (1 if axis else -1)
    left, right = points[:, :2] + half, points[:, :2] - half
    corners = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    return polygons(corners, [0] * PIECES)


def contours(walk: Run) -> Drawing:
    """Lines of equal height on all height fields of a walk's world, or nothing.

    Marks lie at the height of the floor's tops; bumps of millimetres are too flat for
    light and shadow to show them.
    """
    if not walk.scenario.bumps:
        return join([])
    model = walk.model
    fields = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_HFIELD)
    lines = [line for geom in fields for line in _contours_of(model, int(geom))]
    width = CONTOUR_WIDTH * walk.reach
    return join(ribbon(line, np.zeros(len(line), int), width) for line in lines)


def contour_step(walk: Run) -> float:
    """Height from one contour to the next [m]."""
    return walk.scenario.bumps / LEVELS


def _contours_of(model: mujoco.MjModel, geom: int) -> Iterator[Array]:
    """The contours of one field, in the world, shape (n, 2) [m] each."""
    from contourpy import contour_generator  # what matplotlib draws contours with

    field = model.geom_dataid[geom]
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    first = int(model.hfield_adr[field])
    heights = model.hfield_data[first : first + rows * columns].reshape(rows, columns)
    half, (x, y, _) = model.hfield_size[field, :2], model.geom_pos[geom]
    across = contour_generator(
        np.linspace(x - half[0], x + half[0], columns),
        np.linspace(y - half[1], y + half[1], rows),
        heights,
    )
    for level in np.arange(1, LEVELS) / LEVELS:
        yield from map(np.asarray, across.lines(level))
