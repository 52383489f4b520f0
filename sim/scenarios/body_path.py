"""Nominal paths of the body that a scenario can name: line, ellipse and others.

A path is a callable of s in [0, 1] that returns the pose (x [m], y [m], yaw [rad]) in
the frame of the start pose, yaw not wrapped. The planner provides the curves.
"""

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath
from typing import Annotated, Any

import numpy as np

import planner.planning
from planner import Array, Path
from planner.support import read_text
from sim.errors import UsageError, telling
from sim.motion.poses import POSE
from sim.scenarios.declaration import (
    LEAST,
    Range,
    accept,
    is_list,
    refusal,
    require_keys,
    require_kind,
)

Pose = tuple[float, float, float]
START: Pose = (0.0, 0.0, 0.0)
SHORTEST_WAY = 1e-6  # [m]; shares of a shorter one are rounding
FARTHEST_POSE = 1e6  # [m] or [rad]; beyond, rounding would exceed single steps
MOST_POSES, MOST_BYTES = 100_000, 5 * 10**7  # in such a file
WHERE = "the nominal path"
POSES_OR_FILE = 'file = "POSES.csv", or poses = [[0, 0, 0], [x, y, yaw], ...]'

Coordinate = Annotated[float, Range(-FARTHEST_POSE, FARTHEST_POSE)]
Length = Annotated[float, Range(LEAST, FARTHEST_POSE)]
NONE_BEYOND = f"none beyond {FARTHEST_POSE:g}"


@dataclass(frozen=True)
class NominalPath:
    """A curve of poses that starts at (0, 0, 0)."""

    kind: str  # as in a scenario file
    parameter: object  # that it is made from, as in a scenario file
    goal: Pose  # at s = 1
    length: float  # of the (x, y) curve itself [m]; 0 where that is rounding
    curve: Path = field(compare=False, repr=False)  # as the planner takes it
    uncut: Path | None = field(default=None, compare=False, repr=False)  # if divided

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", self.length * (self.length > SHORTEST_WAY))

    def __call__(self, s: float) -> Array:
        """Pose at s, shape (3,)."""
        return self.curve(s)

    def recut(self, cuts: Array) -> "NominalPath":
        """The same path, with s running evenly over the pieces between the cuts."""
        curve = planner.planning.recut(self.curve, cuts)
        return replace(self, curve=curve, uncut=self.undivided)

    @property
    def undivided(self) -> Path:
        """The poses with s running as it did before the path was divided."""
        return self.uncut or self.curve


def line(goal: Sequence[float]) -> NominalPath:
    """Straight to a goal, turning uniformly on the way (Figs. 6, 8)."""
    pose = _pose("path.goal", goal)
    curve = planner.line(START, pose)
    return NominalPath("line", pose, pose, math.hypot(*pose[:2]), curve)


def ellipse(semi_axes: Sequence[float]) -> NominalPath:
    """Once around from its right end, heading constant; semi-axes x, y [m] (Fig. 7)."""
    wanted = f"a list of two lengths above 0 [m], {NONE_BEYOND}"
    axes = accept(semi_axes, tuple[Length, Length], wanted, WHERE, "path.semi_axes")
    length = planner.planning.ellipse_perimeter(axes)
    return NominalPath("ellipse", axes, START, length, planner.ellipse(START, axes))


def waypoints(points: Sequence[Sequence[float]]) -> NominalPath:
    """Straight pieces through two poses or more, the first being the start."""
    poses = _poses("path.points", points)
    length = float(np.hypot(*np.diff(np.array(poses)[:, :2], axis=0).T).sum())
    return NominalPath("waypoints", poses, poses[-1], length, planner.waypoints(poses))


def route(goal: Sequence[float]) -> NominalPath:
    """Straight to a goal, until `planning.routes` finds a way around obstacles."""
    return replace(line(goal), kind="route")


def table(poses: Sequence[Sequence[float]]) -> NominalPath:
    """A smooth curve through two poses or more, the first being the start."""
    points = _poses("path.poses", poses)
    try:
        curve, length = planner.planning.table_curve(points)
    except ValueError as error:
        raise UsageError.at("path.poses", error) from error
    return NominalPath("table", points, points[-1], length, curve)


def formulas(given: Mapping[str, object]) -> NominalPath:
    """Poses x(s), y(s), yaw(s) for s from 0 to 1, at (0, 0, 0) for s = 0.

    They are formulas or numbers by the names x, y and yaw; those missing are 0.
    """
    try:
        curve, length = planner.planning.formula_curve(given)
    except ValueError as error:
        raise UsageError.at("path", error, "write formulas of s") from error
    start, goal = curve(0.0), curve(1.0)
    if np.abs(start).max() > 1e-12:  # [m] or [rad], of a start that counts as (0, 0, 0)
        raise refusal(start.tolist(), "[0, 0, 0], the start pose", WHERE, "path(0)")
    if np.abs(goal).max() > FARTHEST_POSE:
        raise refusal(goal.tolist(), f"numbers, {NONE_BEYOND}", WHERE, "path(1)")
    x, y, yaw = goal.tolist()
    return NominalPath("formulas", dict(given), (x, y, yaw), length, curve)


KINDS: dict[str, tuple[str, Callable[[Any], NominalPath]]] = {
    "line": ("goal = [x, y, yaw] [m, m, rad]", line),
    "ellipse": ("semi_axes = [x, y] [m]", ellipse),
    "waypoints": ("points = [[0, 0, 0], [x, y, yaw], ...] [m, m, rad]", waypoints),
    "route": ("goal = [x, y, yaw] [m, m, rad]", route),
    "table": ("poses = [[0, 0, 0], [x, y, yaw], ...] [m, m, rad]", table),
    "formulas": ("", formulas),
}
"""For each kind its parameter as in a file, none where it is a table of its own, and
what makes it."""


def decode(table: object) -> NominalPath:
    """The path that a table describes: `kind = ...` and the parameter of that kind.

    A table with a goal and no kind is a route. The poses of a `table` may be those of
    a CSV `file` instead.
    """
    if isinstance(table, dict) and table.keys() == {"goal"}:
        table = {"kind": "route", **table}
    table = require_kind(table, "path", KINDS)
    parameter, make = KINDS[table["kind"]]
    if table["kind"] == "formulas":
        require_keys(table, "path of kind formulas", (), POSE)
        return make({name: v for name, v in table.items() if name != "kind"})
    if table["kind"] == "table" and "poses" not in table:
        require_keys(table, "path of kind table", (POSES_OR_FILE,), ("poses",))
        return make(_read_poses(table["file"]))
    require_keys(table, f"path of kind {table['kind']}", (parameter,))
    return make(table[parameter.partition(" ")[0]])


def encode(path: NominalPath) -> dict[str, object]:
    """The table that `decode` turns into the path."""
    if isinstance(path.parameter, Mapping):
        return {"kind": path.kind, **path.parameter}
    return {"kind": path.kind, KINDS[path.kind][0].partition(" ")[0]: path.parameter}


def _read_poses(file: object) -> list[tuple[float, ...]]:
    """Poses from a CSV file with a column for each of `POSE`, in any order."""
    if not isinstance(file, str):
        raise refusal(file, "the name of a CSV file", WHERE, "path.file")
    with telling("cannot be read", file, "give a CSV file that exists", UsageError):
        try:
            return _poses_in(read_text(FilePath(file), MOST_BYTES))
        except csv.Error as error:
            raise UsageError.of("no_poses", file, error=error) from error
        except ValueError as error:
            raise UsageError.at(file, error, "save the table in UTF-8") from error


def _poses(key: str, value: object) -> tuple[Pose, ...]:
    """Two poses or more, the first being the start."""
    if not is_list(value) or not 2 <= len(value) <= MOST_POSES:
        wanted = f"at least two poses [x, y, yaw], at most {MOST_POSES}"
        raise refusal(value, wanted, WHERE, key)
    poses = tuple(_pose(f"{key}[{i}]", pose) for i, pose in enumerate(value))
    if poses[0] != START:
        raise refusal(value[0], "[0, 0, 0], the start pose", WHERE, f"{key}[0]")
    return poses


def _pose(key: str, value: object) -> Pose:
    three = tuple[Coordinate, Coordinate, Coordinate]
    wanted = f"[x, y, yaw] [m, m, rad], such as [0.1, 0, 0], {NONE_BEYOND}"
    return accept(value, three, wanted, WHERE, key)


def _poses_in(text: str) -> list[tuple[float, ...]]:
    """Poses from the text of a table whose first line names the columns."""
    rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    names = [name.strip() for name in next(filter(None, rows), ())]
    if missing := [name for name in POSE if name not in names]:
        raise ValueError(f"no column {missing[0]!r}; begin with the line x,y,yaw")
    if twice := [name for name in POSE if names.count(name) > 1]:
        raise ValueError(f"two columns {twice[0]!r}; name one of them otherwise")
    poses = list[tuple[float, ...]]()
    for row in filter(None, rows):
        if len(row) != len(names):
            cells = f"{len(row)} of {len(names)} columns"
            raise ValueError(f"line {rows.line_num} has {cells}; part them by commas")
        plain = (row[names.index(name)].replace("_", "?") for name in POSE)
        try:
            poses.append(tuple(float(cell.encode("ascii")) for cell in plain))
        except ValueError:
            where = f"line {rows.line_num}"
            raise ValueError(f"{where} holds no pose; give numbers") from None
        if len(poses) > MOST_POSES:
            raise ValueError(f"more than {MOST_POSES} poses; leave some of them out")
    return poses
