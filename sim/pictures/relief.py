"""Contour lines of a floor that is not plane, as on a map.

Marks lie at the height of the floor's tops; bumps of millimetres are too flat for light
and shadow to show them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from planner import Array
from sim.pictures.floor_drawing import Drawing, join, ribbon

if TYPE_CHECKING:
    from sim.pictures.filmed_walk import FilmedWalk

LEVELS = 5  # equal parts of the height that contours divide
FINE = 0.005  # width of a contour [reach of the robot]


def contours(walk: FilmedWalk) -> Drawing:
    """Lines of equal height on all height fields of a walk's world, or nothing.

    Args:
        walk: Whose world.
    """
    if not walk.scenario.bumps:
        return join([])
    model = mujoco.MjModel.from_xml_path(str(walk.model))
    lines = [line for geom in _fields(model) for line in _lines(model, geom)]
    width = FINE * walk.reach
    return join(ribbon(line, np.zeros(len(line), int), width) for line in lines)


def step(walk: FilmedWalk) -> float:
    """Height from one contour to the next [m].

    Args:
        walk: Whose world.
    """
    return walk.scenario.bumps / LEVELS


def _fields(model: mujoco.MjModel) -> Array:
    return np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_HFIELD)


def _lines(model: mujoco.MjModel, geom: int) -> Iterator[Array]:
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
