"""The floor under a walking robot: its present outline, and the area swept so far.

The swept area shows whether the robot kept clear of obstacles.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
import shapely

from models import root_body
from planner import Array
from sim.obstacles.solids import Solids
from sim.pictures.clock import Clock
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.floor_drawing import Drawing, join, polygons, ribbon

FINENESS = 0.002  # by which outlines are simplified [reach of the robot]


def solids(walk: FilmedWalk) -> Solids:
    """The solid parts of a walk's robot."""
    model = mujoco.MjModel.from_xml_path(str(walk.model))
    return Solids(model, root_body(model, walk.model))


def edge(
    robot: Solids, walk: FilmedWalk, clock: Clock, frames: range, width: float
) -> Drawing:
    """The outline in each of some frames, gone in the next.

    Args:
        robot: What of it covers the floor.
        walk: What happened.
        clock: Which row each frame shows.
        frames: Which ones.
        width: Of the line [m].
    """
    shapes = _outlines(robot, walk, clock.rows[frames.start : frames.stop])
    lines = (
        ribbon(ring, np.full(len(ring), frame), width)
        for frame, shape in zip(frames, shapes, strict=True)
        for ring in _rings(shape)
    )
    return join(lines, fleeting=True)


def swept(robot: Solids, walk: FilmedWalk, clock: Clock) -> Drawing:
    """All that the robot has stood over, growing with the frames."""
    shapes = _outlines(robot, walk, clock.rows)
    done, pieces = shapely.Polygon(), []
    for frame, shape in enumerate(shapes):
        triangles = _triangles(shapely.difference(shape, done))
        pieces.append(polygons(triangles, np.full(len(triangles), frame)))
        done = shapely.union(done, shape)
    return join(pieces)


def _outlines(robot: Solids, walk: FilmedWalk, rows: Array) -> Array:
    """The floor covered at each row, shapely geometries, shape (rows,)."""
    parts = robot.covered(walk.qpos[rows])
    return shapely.simplify(shapely.union_all(parts, axis=0), FINENESS * walk.reach)


def _rings(shape: shapely.Geometry) -> Iterator[Array]:
    """Closed lines around a polygon, or several, shape (n, 2) each."""
    for line in shapely.get_parts(shapely.boundary(shape)):
        yield shapely.get_coordinates(line)


def _triangles(shape: shapely.Geometry) -> Array:
    """Triangles that make up a polygon, anticlockwise, shape (n, 3, 2)."""
    flat = shapely.MultiPolygon([p for p in shapely.get_parts(shape) if p.area])
    pieces = shapely.orient_polygons(shapely.constrained_delaunay_triangles(flat))
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)
    return corners[:, :3]
