"""Flat drawings on the floor, as triangles that appear and vanish with the frames."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from planner import Array
from sim import palette
from sim.motion.poses import length_up_to

CORNERS = 24  # of a disc
MOST_DASHES = 5000  # of a line
PIECE = 400  # triangles that are passed to the driver at once


@dataclass(frozen=True)
class Drawing:
    """Triangles in the order of the frames that they first appear in."""

    points: Array  # corners, anticlockwise, (N, 3, 2) [m]
    frames: Array  # first one of each triangle, (N,), ascending
    shapes: Array  # number of each one's; triangles of a shape do not overlap
    life: int | None = None  # frames in which a triangle is seen; None for all later

    def visible(self, frame: int) -> tuple[int, int]:
        """Index of the first triangle to be seen in a frame, and how many follow."""
        stop = int(np.searchsorted(self.frames, frame, side="right"))
        if self.life is None:
            return 0, stop
        start = int(np.searchsorted(self.frames, frame - self.life, side="right"))
        return start, stop - start

    def __len__(self) -> int:
        return len(self.frames)


@dataclass(frozen=True)
class Mark:
    """Drawing of one colour."""

    name: str
    drawing: Drawing
    colour: palette.Colour
    alpha: float = 1.0

    @cached_property
    def pieces(self) -> tuple[tuple[str, Drawing], ...]:
        """Pieces of the drawing with their names; complete ones stay on the card."""
        whole = self.drawing  # as one stays that vanishes again
        cuts = [] if whole.life else range(PIECE, len(whole), PIECE)
        parts = (np.split(a, cuts) for a in (whole.points, whole.frames, whole.shapes))
        return tuple(
            (f"{self.name} {i}", replace(whole, points=p, frames=f, shapes=s))
            for i, (p, f, s) in enumerate(zip(*parts, strict=True))
        )


def join(drawings: Iterable[Drawing], life: int | None = None) -> Drawing:
    """One drawing of several."""
    nothing = np.zeros(0, int)
    points, frames, shapes, count = [np.zeros((0, 3, 2))], [nothing], [nothing], 0
    for drawing in drawings:
        points.append(drawing.points)
        frames.append(drawing.frames)
        shapes.append(drawing.shapes + count)
        count += drawing.shapes.max(initial=-1) + 1
    order = np.argsort(np.concatenate(frames), kind="stable")
    triangles, first, own = (np.concatenate(x)[order] for x in (points, frames, shapes))
    return Drawing(triangles, first, own, life)


def ribbon(line: Array, frames: Array, width: float, jump: float = np.inf) -> Drawing:
    """A line of constant width, each piece appearing with the point it leads to.

    Repeated points and pieces longer than a jump [m] are left out.
    """
    step = np.diff(line, axis=0)
    length = np.hypot(*step.T)
    moved = (length > 0) & (length <= jump)
    along = step[moved] / length[moved, None] * width / 2
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    # Half a width too long at both ends: no notches where the direction changes.
    start, end = line[:-1][moved] - along, line[1:][moved] + along
    corners = (start - across, end - across, end + across, start + across)
    halves = np.stack(corners, axis=1)[:, [[0, 1, 2], [0, 2, 3]]]  # (N, 2, 3, 2)
    shapes = np.repeat(np.arange(len(halves)), 2)
    return Drawing(halves.reshape(-1, 3, 2), np.repeat(frames[1:][moved], 2), shapes)


def dashes(line: Array, period: float, width: float) -> Drawing:
    """A dashed line that is there from the first frame on; a period is dash and gap."""
    way, pieces = length_up_to(line), []
    for start in np.arange(0.0, way[-1], period := max(period, way[-1] / MOST_DASHES)):
        stop = min(start + 0.5 * period, way[-1])
        at = np.concatenate([[start], way[(way > start) & (way < stop)], [stop]])
        piece = np.stack([np.interp(at, way, c) for c in line.T], axis=1)
        pieces.append(ribbon(piece, np.zeros(len(piece), int), width))
    return join(pieces)


def discs(
    centres: Array, frames: Iterable[int], radius: float, corners: int = CORNERS
) -> Drawing:
    """Round spots at centres, (N, 2) [m]; few corners are drawn faster."""
    angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    rim = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return polygons([c + rim for c in centres], frames)


def polygons(outlines: Iterable[Array], frames: Iterable[int]) -> Drawing:
    """Filled convex polygons with their frames; corners anticlockwise, (n, 2) [m]."""
    fans = []
    for outline, frame in zip(outlines, frames, strict=True):
        n = max(len(outline) - 2, 0)
        first = np.repeat(outline[:1], n, 0)
        fan = np.stack([first, outline[1:-1], outline[2:]], axis=1)
        fans.append(Drawing(fan, np.full(n, frame), np.zeros(n, int)))
    return join(fans)
