"""Nominal paths of the body that a scenario can name: line, ellipse, waypoints.

A path is a callable of s in [0, 1] that returns the pose (x [m], y [m], yaw [rad]) in
the frame of the start pose; yaw is continuous, not wrapped. How a path is cut into
segments and followed is the planner's.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import ClassVar

import numpy as np

from sim.errors import UsageError
from sim.settings import is_number, nearest

Array = np.ndarray
Pose = tuple[float, float, float]
START: Pose = (0.0, 0.0, 0.0)
LARGEST = 1e6  # [m] or [rad]; far beyond, rounding would swallow single steps


@dataclass(frozen=True)
class Line:
    """Straight from the start to a goal, turning uniformly on the way (Figs. 6, 8)."""

    kind: ClassVar[str] = "line"
    goal: Pose

    def __post_init__(self) -> None:
        object.__setattr__(self, "goal", _pose("path.goal", self.goal))

    def __call__(self, s: float) -> Array:
        """Pose at s, shape (3,)."""
        return s * np.array(self.goal)

    @property
    def length(self) -> float:
        """Arc length of the (x, y) curve [m]."""
        return math.hypot(*self.goal[:2])


@dataclass(frozen=True)
class Ellipse:
    """Once around at constant heading, starting at the ellipse's right end (Fig. 7)."""

    kind: ClassVar[str] = "ellipse"
    semi_axes: tuple[float, float]  # along x and y [m]
    goal: ClassVar[Pose] = START

    def __post_init__(self) -> None:
        axes = _numbers("path.semi_axes", self.semi_axes, 2, "two lengths above 0 [m]")
        if min(axes) <= 0:
            raise _refusal("path.semi_axes", self.semi_axes, "two lengths above 0 [m]")
        object.__setattr__(self, "semi_axes", axes)

    def __call__(self, s: float) -> Array:
        """Pose at s, shape (3,)."""
        a, b = self.semi_axes
        angle = 2 * math.pi * s
        return np.array([a * math.cos(angle) - a, b * math.sin(angle), 0.0])

    @property
    def length(self) -> float:
        """Arc length of the (x, y) curve [m], by the complete elliptic integral."""
        from scipy.special import (
            ellipe,
        )  # a third of a second that --help need not wait

        minor, major = sorted(self.semi_axes)
        return float(4 * major * ellipe(1 - (minor / major) ** 2))


@dataclass(frozen=True)
class Waypoints:
    """Straight pieces through poses, the first being the start.

    s is shared out by the length of the pieces; a turn on the spot counts as an arc of
    radius `TURN_RADIUS`.
    """

    kind: ClassVar[str] = "waypoints"
    TURN_RADIUS: ClassVar[float] = 0.1  # [m], about that of the shipped robots' feet
    points: tuple[Pose, ...]

    def __post_init__(self) -> None:
        points = self.points
        if (
            isinstance(points, str)
            or not isinstance(points, Sequence)
            or len(points) < 2
        ):
            raise _refusal("path.points", points, "at least two poses [x, y, yaw]")
        poses = tuple(_pose(f"path.points[{i}]", p) for i, p in enumerate(points))
        if poses[0] != START:
            raise _refusal(
                "path.points[0]", list(poses[0]), "[0, 0, 0], the start pose"
            )
        object.__setattr__(self, "points", poses)

    def __call__(self, s: float) -> Array:
        """Pose at s, shape (3,)."""
        return np.array([np.interp(s, self._stations, c) for c in self._array.T])

    @property
    def goal(self) -> Pose:
        """The last point."""
        return self.points[-1]

    @property
    def length(self) -> float:
        """Arc length of the (x, y) curve [m]."""
        return float(np.hypot(*np.diff(self._array[:, :2], axis=0).T).sum())

    @cached_property
    def _array(self) -> Array:
        return np.array(self.points)

    @cached_property
    def _stations(self) -> Array:
        """Value of s at each point, shape (len(points),)."""
        scaled = self._array * (1, 1, self.TURN_RADIUS)
        pieces = np.linalg.norm(np.diff(scaled, axis=0), axis=1)
        way = np.concatenate([[0.0], np.cumsum(pieces)])
        return way / way[-1] if way[-1] else np.linspace(0, 1, len(way))


NominalPath = Line | Ellipse | Waypoints
KINDS: dict[str, type[Line] | type[Ellipse] | type[Waypoints]] = {
    path.kind: path for path in (Line, Ellipse, Waypoints)
}


def decode(table: object) -> NominalPath:
    """The path that a table `kind = ...` with its parameters describes.

    Raises:
        UsageError: If a key is missing, unknown, or its value impossible.
    """
    if not isinstance(table, dict) or not isinstance(table.get("kind"), str):
        raise _refusal("path", table, f"a table with kind = {' or '.join(KINDS)}")
    if table["kind"] not in KINDS:
        known = nearest(table["kind"], KINDS)
        raise UsageError(f"unknown path kind {table['kind']!r}", "path.kind", known)
    path = KINDS[table["kind"]]
    keys = {item.name for item in fields(path)}
    for key in table.keys() - keys - {"kind"}:
        where = f"path of kind {path.kind}"
        raise UsageError(f"unknown key {key!r}", where, nearest(key, sorted(keys)))
    for key in keys - table.keys():
        raise UsageError(
            f"{key} is missing", f"path of kind {path.kind}", f"give {key}"
        )
    return path(**{key: table[key] for key in keys})


def encode(path: NominalPath) -> dict[str, object]:
    """The table that `decode` turns into the path."""
    values = {item.name: getattr(path, item.name) for item in fields(path)}
    return {"kind": path.kind, **values}


def _pose(key: str, value: object) -> Pose:
    x, y, yaw = _numbers(key, value, 3, "x [m], y [m], yaw [rad]")
    return x, y, yaw


def _numbers(key: str, value: object, count: int, wanted: str) -> tuple[float, ...]:
    wanted = f"{wanted}, none beyond {LARGEST:g}"
    if isinstance(value, str) or not isinstance(value, Sequence) or len(value) != count:
        raise _refusal(key, value, wanted)
    if not all(is_number(item) and abs(item) <= LARGEST for item in value):
        raise _refusal(key, value, wanted)
    return tuple(float(item) for item in value)


def _refusal(key: str, value: object, wanted: str) -> UsageError:
    what = f"{key} = {reprlib.repr(value)} is not allowed"
    return UsageError(what, "the nominal path", f"give {wanted}")
