"""Marks on the floor: outline, footprints, paths, support polygon, weight and goal.

A walk is turned into coloured drawings, frame by frame; `pictures.offscreen` draws it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from planner import Array
from sim.motion.polylines import spaced_rows
from sim.motion.stability import support_polygons
from sim.pictures import relief, style, swept_area
from sim.pictures.clock import Clock
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.floor_drawing import (
    Drawing,
    dashes,
    discs,
    join,
    polygons,
    ribbon,
)

# In units of the robot's reach.
SPACING, JUMP = 0.006, 0.03  # between points of a path; a longer step is no path
DASH = 0.08
FINE, THIN, WIDE = 0.006, 0.01, (0.014, 0.01)  # widths of lines
FOOT, TRAIL = 0.014, 0.012  # radius of a footprint, width of its slip
SPOT, GOAL = 0.032, 0.06  # radii
BEND = 0.1  # [rad] that a path turns between its points, or
BEAT = 6  # pictures; what comes first
FEW = 8  # corners of a footprint, which is a few pixels wide
PIECE = 400  # triangles that are passed to the driver at once


@dataclass(frozen=True)
class Mark:
    """Drawing of one colour."""

    name: str
    drawing: Drawing
    colour: style.Colour
    alpha: float = 1.0

    @cached_property
    def pieces(self) -> tuple[tuple[str, Drawing], ...]:
        """Pieces of the drawing with their names; complete ones stay on the card."""
        parts = self.drawing.pieces(PIECE)
        return tuple((f"{self.name} {i}", part) for i, part in enumerate(parts))


def marks(walk: FilmedWalk, clock: Clock, frames: range) -> tuple[Mark, ...]:
    """Everything that is drawn on the floor, the lowest first.

    Args:
        walk: Finished walk.
        clock: Which row each frame shows.
        frames: Frames to be drawn; what moves with the robot is drawn for these only.
    """
    drawn = (
        Mark("contours of the floor", relief.contours(walk), style.RELIEF),
        *_covered(walk, clock, frames),
        *_support(walk, clock, frames),
        *_footprints(walk, clock),
        *_goal(walk),
        *_predicted(walk, clock),
        Mark("achieved path", _path(walk, clock, walk.achieved, FINE), style.ACHIEVED),
        Mark("nominal path", _nominal(walk), style.NOMINAL),
        *_weight(walk, clock, frames),
    )
    return tuple(mark for mark in drawn if len(mark.drawing))


def _covered(walk: FilmedWalk, clock: Clock, frames: range) -> Iterator[Mark]:
    """The robot's outline; beside obstacles also the floor that it swept over."""
    robot = swept_area.solids(walk)
    if walk.scenario.obstacles:
        yield Mark(
            "floor swept over", swept_area.swept(robot, walk, clock), style.SWEPT
        )
    edge = swept_area.edge(robot, walk, clock, frames, THIN * walk.reach)
    yield Mark("outline of the robot", edge, style.OUTLINE)


def _nominal(walk: FilmedWalk) -> Drawing:
    return dashes(walk.nominal[:, :2], DASH * walk.reach, THIN * walk.reach)


def _goal(walk: FilmedWalk) -> Iterator[Mark]:
    """A ring where the nominal path ends."""
    end, first = walk.nominal[-1:, :2], np.zeros(1, int)
    for name, share, colour in (
        ("goal", 1.0, style.NOMINAL),
        ("goal's eye", 0.75, style.PAPER),
    ):
        yield Mark(name, discs(end, first, share * GOAL * walk.reach), colour)


def _predicted(walk: FilmedWalk, clock: Clock) -> Iterator[Mark]:
    """The predicted path of the body, wider than the actual one and below it."""
    for i, (name, poses) in enumerate(walk.predicted.items()):
        yield Mark(name, _path(walk, clock, poses, WIDE[i]), style.PREDICTED[i])


def _path(walk: FilmedWalk, clock: Clock, poses: Array, width: float) -> Drawing:
    """The path of the body's centre so far."""
    rows = spaced_rows(poses[:, :2], SPACING * walk.reach)
    rows = rows[_telling(poses[rows], clock.frame_of(rows))]
    frames = clock.frame_of(rows)
    return ribbon(poses[rows, :2], frames, width * walk.reach, JUMP * walk.reach)


def _telling(line: Array, frames: Array) -> Array:
    """Which points a line needs to keep its corners and to grow without haste."""
    step = np.diff(line[:, :2], axis=0)
    turn = np.diff(np.arctan2(step[:, 1], step[:, 0]))
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.angle(np.exp(1j * turn))))])
    corners = np.flatnonzero(np.diff(np.floor(turned / BEND))) + 1
    beats = np.unique(frames // BEAT, return_index=True)[1]
    return np.unique(np.concatenate([corners, beats, [len(line) - 1]]).astype(int))


def _footprints(walk: FilmedWalk, clock: Clock) -> Iterator[Mark]:
    """Where the feet of each group stood, and how they slipped while they did."""
    for group, name in enumerate(walk.groups):
        feet = [i for i, owner in enumerate(walk.group_of_foot) if owner == group]
        drawing = join(
            drawing for foot in feet for drawing in _stands(walk, clock, foot)
        )
        yield Mark(f"footprints of {name}", drawing, style.footprint(group))


def _stands(walk: FilmedWalk, clock: Clock, foot: int) -> Iterator[Drawing]:
    """A spot where a foot came down, and its trail until it was raised."""
    place = walk.contact_point[:, foot]
    touched = np.concatenate([[False], walk.contact[:, foot], [False]])
    starts, stops = np.flatnonzero(touched[1:] != touched[:-1]).reshape(-1, 2).T
    yield discs(place[starts], clock.frame_of(starts), FOOT * walk.reach, FEW)
    for start, stop in zip(starts, stops, strict=True):
        rows = start + spaced_rows(place[start:stop], TRAIL * walk.reach)
        yield ribbon(place[rows], clock.frame_of(rows), TRAIL * walk.reach)


def _support(walk: FilmedWalk, clock: Clock, frames: range) -> Iterator[Mark]:
    """The convex hull of the feet in contact, red where the weight has left it."""
    rows = clock.rows[frames.start : frames.stop]
    hulls = support_polygons(walk.contact_point[rows], walk.contact[rows])
    stable = walk.margin[rows] > 0
    for name, colour, chosen in (
        ("support polygon", style.STABLE, stable),
        ("support polygon, tipping", style.TIPPING, ~stable),
    ):
        outlines = [(frames[i], _corners(hulls[i])) for i in np.flatnonzero(chosen)]
        filled = polygons([c for _, c in outlines], [f for f, _ in outlines])
        edges = (
            ribbon(np.vstack([c, c[:1]]), np.full(len(c) + 1, frame), THIN * walk.reach)
            for frame, c in outlines
        )
        yield Mark(name, join([filled], fleeting=True), colour, alpha=0.25)
        yield Mark(f"edge of the {name}", join(edges, fleeting=True), colour)


def _corners(hull: shapely.Geometry) -> Array:
    """Corners of a polygon, anticlockwise; ends of a segment; shape (n, 2)."""
    if isinstance(hull, shapely.Polygon):
        return shapely.get_coordinates(shapely.orient_polygons(hull))[:-1]
    return shapely.get_coordinates(hull)


def _weight(walk: FilmedWalk, clock: Clock, frames: range) -> Iterator[Mark]:
    """The centre of mass, projected on the floor."""
    rows = clock.rows[frames.start : frames.stop]
    centres = walk.center_of_mass[rows]
    for name, share, colour in (
        ("rim of the centre of mass", 1.4, style.PAPER),
        ("centre of mass", 1.0, style.WEIGHT),
    ):
        spots = discs(centres, np.array(frames), share * SPOT * walk.reach)
        yield Mark(name, join([spots], fleeting=True), colour)
