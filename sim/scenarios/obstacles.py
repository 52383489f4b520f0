"""Obstacles that a scenario can place on the floor: walls, boxes and polygons.

All are upright prisms in the frame of the start pose. Each obstacle is divided into
convex pieces once, so that the engine and the planner use the same solids.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely

from planner import Array
from sim.scenarios.declaration import is_number
from sim.scenarios.tables import (
    Table,
    is_list,
    numbers,
    refusal,
    require_keys,
    require_kind,
)

Point = tuple[float, float]

THICKNESS = 0.02  # of a wall [m], if it says nothing
HEIGHT = 0.12  # [m], above the shipped robots
FARTHEST = 1e3  # [m] from the start
SMALLEST_SIZE = 1e-4  # [m]; smaller sizes are taken for mistakes


@dataclass(frozen=True)
class Box:
    """A rectangle on the floor; the engine has a box for it."""

    center: Point  # [m]
    half: Point  # sizes along its own axes [m]
    yaw: float  # [rad]

    @property
    def corners(self) -> Array:
        """Counter-clockwise, shape (4, 2) [m]."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        own = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * self.half
        return own @ np.array([(cos, sin), (-sin, cos)]) + self.center


@dataclass(frozen=True)
class Prism:
    """A convex polygon on the floor."""

    points: tuple[Point, ...]

    @property
    def corners(self) -> Array:
        """Shape (n, 2) [m]."""
        return np.array(self.points)


Piece = Box | Prism
Pieces = tuple[Piece, ...]


@dataclass(frozen=True)
class Obstacle:
    """An obstacle on the floor.

    Attributes:
        kind: Its kind, as in a scenario file.
        given: The values that it is made from, as in a scenario file.
        height: Above the floor [m].
        pieces: Convex solids that it consists of.
    """

    kind: str
    given: tuple[tuple[str, object], ...]
    height: float
    pieces: Pieces = field(compare=False, repr=False)

    @property
    def area(self) -> shapely.Geometry:
        """The floor it covers."""
        return shapely.union_all([shapely.Polygon(p.corners) for p in self.pieces])


def decode(tables: object) -> tuple[Obstacle, ...]:
    """The obstacles that a scenario's list of tables describes.

    Raises:
        UsageError: If a key is missing or unknown, or a value impossible; it names the
            obstacle by its place in the list, from 1.
    """
    if not is_list(tables):
        raise refusal("", tables, "obstacles", "a list of tables, [[obstacles]]")
    return tuple(_decode(table, f"obstacle {i}") for i, table in enumerate(tables, 1))


def encode(obstacle: Obstacle) -> dict[str, object]:
    """The table that `decode` turns into the obstacle."""
    return {"kind": obstacle.kind, **dict(obstacle.given)}


def _wall(table: Table, where: str) -> Pieces:
    """A chain of straight pieces, each longer by the thickness to close the corners."""
    points = _points(table["points"], f"{where}: points", 2)
    thickness = _length(table.get("thickness", THICKNESS), f"{where}: thickness")
    return tuple(_between(a, b, thickness) for a, b in pairwise(points))


def _between(a: Point, b: Point, thickness: float) -> Box:
    dx, dy = b[0] - a[0], b[1] - a[1]
    return Box(
        center=((a[0] + b[0]) / 2, (a[1] + b[1]) / 2),
        half=((math.hypot(dx, dy) + thickness) / 2, thickness / 2),
        yaw=math.atan2(dy, dx),
    )


def _box(table: Table, where: str) -> Pieces:
    center = _point(table["center"], f"{where}: center")
    size = _numbers(table["size"], f"{where}: size", "two lengths above 0 [m]")
    if min(size) < SMALLEST_SIZE:
        raise refusal("", table["size"], f"{where}: size", "two lengths above 0 [m]")
    yaw = table.get("yaw", 0.0)
    if not is_number(yaw) or not math.isfinite(yaw):
        raise refusal("", yaw, f"{where}: yaw", "an angle [rad]")
    return (Box(center, (size[0] / 2, size[1] / 2), float(yaw)),)


def _polygon(table: Table, where: str) -> Pieces:
    """The polygon itself if it is convex, else triangles."""
    points = _points(table["points"], f"{where}: points", 3)
    polygon = shapely.Polygon(points)
    if not polygon.is_valid or polygon.area < SMALLEST_SIZE**2:
        wanted = "corners of a polygon in order, no sides crossing"
        raise refusal("", table["points"], f"{where}: points", wanted)
    if math.isclose(polygon.area, polygon.convex_hull.area, rel_tol=1e-9):
        return (_prism(polygon),)
    triangles = shapely.constrained_delaunay_triangles(polygon)
    return tuple(map(_prism, triangles.geoms))


def _prism(polygon: shapely.Polygon) -> Prism:
    corners = polygon.exterior.coords[:-1]
    return Prism(tuple((float(x), float(y)) for x, y in corners))


KINDS: Mapping[
    str,
    tuple[tuple[str, ...], tuple[str, ...], Callable[[Table, str], tuple[Piece, ...]]],
] = {
    "wall": (("points",), ("thickness",), _wall),
    "box": (("center", "size"), ("yaw",), _box),
    "polygon": (("points",), (), _polygon),
}
"""For each kind the keys it must have, those it may have, and what makes its pieces."""


def _decode(values: object, where: str) -> Obstacle:
    table = require_kind(values, where, KINDS)
    kind = table["kind"]
    needed, allowed, make = KINDS[kind]
    require_keys(table, where, needed, (*allowed, "height"))
    height = _length(table.get("height", HEIGHT), f"{where}: height")
    given = tuple(
        (key, _frozen(value)) for key, value in table.items() if key != "kind"
    )
    return Obstacle(kind, given, height, make(table, where))


def _frozen(value: object) -> object:
    """Lists as tuples, all the way down."""
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value


def _points(value: object, where: str, least: int) -> tuple[Point, ...]:
    if not is_list(value) or len(value) < least:
        raise refusal("", value, where, f"at least {least} points [x, y] [m]")
    points = tuple(_point(point, where) for point in value)
    for a, b in pairwise(points):
        if math.dist(a, b) < SMALLEST_SIZE:
            wanted = "points that differ from one to the next"
            raise refusal("", value, where, wanted)
    return points


def _point(value: object, where: str) -> Point:
    return _numbers(value, where, "a point [x, y] [m]")


def _numbers(value: object, where: str, wanted: str) -> Point:
    x, y = numbers(value, 2, FARTHEST, "", where, wanted)
    return x, y


def _length(value: object, where: str) -> float:
    if not is_number(value) or not SMALLEST_SIZE <= value <= FARTHEST:
        wanted = f"a length from {SMALLEST_SIZE:g} to {FARTHEST:g} m"
        raise refusal("", value, where, wanted)
    return float(value)
