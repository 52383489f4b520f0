"""Obstacles that a scenario can place on the floor: walls, boxes and polygons.

All are upright prisms in the frame of the start pose, in convex pieces, so that the
engine and the planner use the same solids.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated

import numpy as np
import shapely

from planner import Array
from sim.errors import UsageError
from sim.scenarios import declaration

Point = tuple[float, float]

OBSTACLE_HEIGHT = 0.12  # [m], above the shipped robots
FARTHEST = 1e3  # [m] from the start
MOST_CORNERS = 3000  # of all obstacles, which take seconds to compile
MOST_PAIRS = 4 * 10**5  # of their sides near one another; ten seconds, half a gigabyte
SMALLEST_SIZE = 1e-4  # [m]; smaller sizes are taken for mistakes

Coordinate = Annotated[float, declaration.Range(-FARTHEST, FARTHEST)]
Length = Annotated[float, declaration.Range(SMALLEST_SIZE, FARTHEST)]
Finite = Annotated[float, declaration.Range(-1e308, 1e308)]
A_LENGTH = Length, f"a length from {SMALLEST_SIZE:g} to {FARTHEST:g} m"
A_POINT = tuple[Coordinate, Coordinate], f"a point [x, y] [m], none beyond {FARTHEST:g}"
FORMS: Mapping[str, tuple[object, str]] = {
    "center": A_POINT,
    "size": (tuple[Length, Length], f"two lengths above 0, none beyond {FARTHEST:g} m"),
    "yaw": (Finite, "an angle [rad]"),
    "thickness": A_LENGTH,
    "height": A_LENGTH,
}  # kinds of values by their keys, and what is wanted where a value is none


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


@dataclass(frozen=True, eq=False)
class Prism:
    """A convex polygon on the floor."""

    corners: Array  # shape (n, 2) [m]


Piece = Box | Prism
Pieces = tuple[Piece, ...]


@dataclass(frozen=True)
class Obstacle:
    """An obstacle on the floor."""

    kind: str  # as in a scenario file
    given: tuple[tuple[str, object], ...]  # that it is made from, as in such a file
    height: float  # above the floor [m]
    pieces: Pieces = field(compare=False, repr=False)  # convex solids

    @property
    def area(self) -> shapely.Geometry:
        """The floor it covers."""
        return shapely.union_all([shapely.Polygon(p.corners) for p in self.pieces])


def decode(tables: object) -> tuple[Obstacle, ...]:
    """The obstacles that a scenario's list of tables describes, counted from 1."""
    if not declaration.is_list(tables):
        wanted = "a list of tables, [[obstacles]]"
        raise declaration.refusal(tables, wanted, "obstacles")
    points = [table.get("points") for table in tables if isinstance(table, Mapping)]
    corners = sum(len(one) if declaration.is_list(one) else 1 for one in points)
    if corners > MOST_CORNERS:
        raise UsageError.of("corners", "obstacles", count=corners, most=MOST_CORNERS)
    found = [_decode(table, f"obstacle {i}") for i, table in enumerate(tables, 1)]
    if found:
        _require_few_crossings(found)
    return tuple(found)


def _require_few_crossings(obstacles: Sequence[Obstacle]) -> None:
    """Refuse outlines that may cross so often that the floor between has many parts."""
    rings: list[Array] = []
    for one in obstacles:  # the outline of a polygon, which does not cross itself
        given = np.array(dict(one.given).get("points", ()), dtype=float)
        prism = isinstance(one.pieces[0], Prism)
        rings += [given] if prism else [piece.corners for piece in one.pieces]
    sides = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings]
    edges, pairs = shapely.linestrings(np.concatenate(sides)), 0
    owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
    tree = shapely.STRtree(edges)
    for start in range(0, len(edges), 200):  # more take much memory at once
        at, near = tree.query(edges[start : start + 200])  # whose bounds meet
        pairs += int((owner[start + at] != owner[near]).sum())
        if pairs > MOST_PAIRS:
            raise UsageError.of("crossings", "obstacles")


def encode(obstacle: Obstacle) -> dict[str, object]:
    """The table that `decode` turns into the obstacle."""
    return {"kind": obstacle.kind, **dict(obstacle.given)}


def _wall(points: Sequence[Point], values: declaration.Table) -> Pieces:
    """A chain of straight pieces, each longer by the thickness to close the corners."""
    thickness = values.get("thickness", 0.02)  # of a wall [m]
    pieces = []
    for (x, y), (next_x, next_y) in pairwise(points):
        dx, dy = next_x - x, next_y - y
        half = (math.hypot(dx, dy) + thickness) / 2, thickness / 2
        center = (x + next_x) / 2, (y + next_y) / 2
        pieces.append(Box(center, half, math.atan2(dy, dx)))
    return tuple(pieces)


def _box(_: Sequence[Point], values: declaration.Table) -> Pieces:
    width, depth = values["size"]
    return (Box(values["center"], (width / 2, depth / 2), values.get("yaw", 0.0)),)


def _polygon(points: Sequence[Point], _: declaration.Table) -> Pieces:
    """The polygon itself if it is convex, else triangles."""
    polygon = shapely.Polygon(points)
    if not polygon.is_valid or polygon.area < SMALLEST_SIZE**2:
        raise ValueError("corners of a polygon in order, no sides crossing")
    parts = [polygon]
    if not math.isclose(polygon.area, polygon.convex_hull.area, rel_tol=1e-9):
        parts = shapely.constrained_delaunay_triangles(polygon).geoms
    return tuple(Prism(np.array(part.exterior.coords[:-1])) for part in parts)


KINDS: Mapping[str, tuple[int, tuple[str, ...], tuple[str, ...], Callable[..., Pieces]]]
KINDS = {
    "wall": (2, ("points = [[x, y], ...] [m]",), ("thickness",), _wall),
    "box": (0, ("center = [x, y] [m]", "size = [x, y] [m]"), ("yaw",), _box),
    "polygon": (3, ("points = [[x, y], ...] [m]",), (), _polygon),
}
"""For each kind how many points it has at least, the keys it must have, those it may
have, and what makes its pieces, or says which points would be possible."""


def _decode(given: object, where: str) -> Obstacle:
    table = declaration.require_kind(given, where, KINDS)
    least, needed, allowed, make = KINDS[table["kind"]]
    declaration.require_keys(table, where, needed, (*allowed, "height"))
    values = {
        key: declaration.accept(value, *FORMS[key], f"{where}: {key}")
        for key, value in table.items()
        if key in FORMS
    }
    at, points = f"{where}: points", table.get("points", ())
    if not declaration.is_list(points) or len(points) < least:
        raise declaration.refusal(points, f"at least {least} points [x, y] [m]", at)
    corners = [declaration.accept(point, *A_POINT, at) for point in points]
    if any(math.dist(a, b) < SMALLEST_SIZE for a, b in pairwise(corners)):
        raise declaration.refusal(points, "points that differ from one to the next", at)
    try:
        pieces = make(corners, values)
    except ValueError as error:
        raise declaration.refusal(points, str(error), at) from error
    own = tuple((key, _frozen(v)) for key, v in table.items() if key != "kind")
    return Obstacle(table["kind"], own, values.get("height", OBSTACLE_HEIGHT), pieces)


def _frozen(value: object) -> object:
    """Lists as tuples, all the way down."""
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value
