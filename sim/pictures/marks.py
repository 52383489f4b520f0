"""Marks on the floor: grid, contours, footprints, paths, support polygon and goal.

They are drawings: without a graphics card, a texture would take as much time as the
rest of the picture.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
import shapely

from models.description import root_body
from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.motion.stability import support_polygons
from sim.obstacles.clearance import Solids
from sim.palette import NOMINAL, THOUGHT, PathMark
from sim.pictures.camera import Camera
from sim.pictures.clock import FRAME_RATE, Clock
from sim.pictures.drawing import Drawing, Mark, dashes, discs, join, polygons, ribbon
from sim.runs.run import Run

# In units of the robot's reach.
CELLS = 0.5  # of the grid, about
SPACING, JUMP = 0.006, 0.03  # between points of a path; a longer step is no path
TRAIL = 0.012  # width of the slip of a foot
FINENESS = 0.002  # by which outlines are simplified

ROUND = (1.0, 2.0, 5.0, 10.0)
PIECES = 12  # of a line of the grid, each as wide as makes it even in the picture
FRAMES = 9  # at which it is asked how far away a line is
LEVELS = 5  # equal parts of the height that contours divide
BEND = 0.1  # [rad] that a path turns between its points, or
BEAT = 6  # pictures; what comes first
FADING = ((0.25, None), (0.45, 8 * FRAME_RATE), (0.75, 3 * FRAME_RATE))
"""Strength of a footprint's colour, and in how many pictures it is so strong."""


def marks(walk: Run, clock: Clock, frames: range) -> tuple[Mark, ...]:
    """All marks but the grid, the lowest first; what moves is drawn for `frames`."""
    dash, width = 0.08 * walk.reach, NOMINAL.width * walk.reach
    nominal = dashes(walk.nominal[:, :2], dash, width)
    end, first, radius = walk.nominal[-1:, :2], [0], palette.GOAL * walk.reach
    covered = join([])
    if walk.scenario.obstacles:
        robot = Solids(walk.model, root_body(walk.model, walk.model_file))
        covered = swept(robot, walk, clock)
    drawn = (
        Mark("contours of the floor", contours(walk), palette.RELIEF),
        Mark("floor swept over", covered, palette.SWEPT),
        *_support(walk, clock, frames),
        *_footprints(walk, clock),
        Mark("goal", discs(end, first, radius), NOMINAL.colour),
        Mark("goal's eye", discs(end, first, 0.75 * radius), palette.PAPER),
        # The achieved path is wider than predicted ones, and covers what came true.
        *(_path(walk, clock, p, palette.PREDICTED[n]) for n, p in walk.drawn.items()),
        _path(walk, clock, walk.achieved, palette.ACHIEVED),
        _thought(walk, clock),
        Mark(NOMINAL.label, nominal, NOMINAL.colour),
    )
    return tuple(mark for mark in drawn if len(mark.drawing))


def cell(reach: float) -> float:
    """Side of a cell of the grid for a robot's reach, a round length [m]."""
    power = 10.0 ** np.floor(np.log10(CELLS * reach))
    return float(power * min(ROUND, key=lambda r: abs(r - CELLS * reach / power)))


def grid(view: Camera, reach: float) -> Mark:
    """Lines along x and y on all of the floor that a film will show."""
    low, high = view.floor_seen()
    side = cell(max(reach, float((high - low).max()) / 500))  # lines, or some more
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
    half[:, axis] = 1.8 * pixel * away / 2 * (1 if axis else -1)  # 1.8 pixels
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
    width = 0.005 * walk.reach
    return join(ribbon(line, np.zeros(len(line), int), width) for line in lines)


def _contours_of(model: mujoco.MjModel, geom: int) -> Iterator[Array]:
    """The contours of one field, in the world, shape (n, 2) [m] each."""
    from contourpy import contour_generator  # what matplotlib draws contours with

    field = model.geom_dataid[geom]
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    heights = model.hfield_data[int(model.hfield_adr[field]) :][: rows * columns]
    middle, half = model.geom_pos[geom, :2], model.hfield_size[field, :2]
    (low_x, low_y), (high_x, high_y) = middle - half, middle + half
    x, y = np.linspace(low_x, high_x, columns), np.linspace(low_y, high_y, rows)
    across = contour_generator(x, y, heights.reshape(rows, columns))
    for level in np.arange(1, LEVELS) / LEVELS:
        yield from map(np.asarray, across.lines(level))


def _path(walk: Run, clock: Clock, poses: Array, style: PathMark) -> Mark:
    rows = spaced_rows(poses[:, :2], SPACING * walk.reach)
    rows = rows[_telling(poses[rows], clock.frame_of(rows))]
    width, jump = style.width * walk.reach, JUMP * walk.reach
    line = ribbon(poses[rows, :2], clock.frame_of(rows), width, jump)
    return Mark(style.label, line, style.colour)


def _thought(walk: Run, clock: Clock) -> Mark:
    """Where feedback thought the body to be, from each stop on."""
    rows = np.searchsorted(walk.time, [stop.time for stop in walk.stops])
    frames = clock.frame_of(np.minimum(rows, len(walk.time) - 1))
    lines = (
        ribbon(outline, np.full(len(outline), frame), THOUGHT.width * walk.reach)
        for outline, frame in zip(walk.thought, frames, strict=False)
    )
    return Mark(THOUGHT.label, join(lines), THOUGHT.colour)


def _telling(line: Array, frames: Array) -> Array:
    """Which points a line needs to keep its corners and to grow without haste."""
    step = np.diff(line[:, :2], axis=0)
    turn = np.diff(np.arctan2(step[:, 1], step[:, 0]))
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.angle(np.exp(1j * turn))))])
    corners = np.flatnonzero(np.diff(np.floor(turned / BEND))) + 1
    beats = np.unique(frames // BEAT, return_index=True)[1]
    return np.unique(np.concatenate([corners, beats, [len(line) - 1]]).astype(int))


def _footprints(walk: Run, clock: Clock) -> Iterator[Mark]:
    """Where feet stood and how they slipped, thrice: palest and for ever below."""
    for age, (strength, life) in enumerate(FADING):
        for group, name in enumerate(walk.card.groups):
            feet = np.flatnonzero(np.equal(walk.group_of_foot, group)).tolist()
            stands = [s for foot in feet for s in _stands(walk, clock, foot)]
            ink = palette.group(group).tint(strength)
            yield Mark(f"footprints of {name}, {age}", join(stands, life), ink)


def _stands(walk: Run, clock: Clock, foot: int) -> Iterator[Drawing]:
    """A spot where a foot came down, and its trail until it was raised."""
    place = walk.contact_point[:, foot]
    edges = np.diff(walk.contact[:, foot], prepend=False, append=False)
    starts, stops = np.flatnonzero(edges).reshape(-1, 2).T
    frames, radius = clock.frame_of(starts), palette.FOOTPRINT * walk.reach
    yield discs(place[starts], frames, radius, corners=8)  # few pixels wide
    for start, stop in zip(starts, stops, strict=True):
        rows = start + spaced_rows(place[start:stop], TRAIL * walk.reach)
        yield ribbon(place[rows], clock.frame_of(rows), TRAIL * walk.reach)


def _support(walk: Run, clock: Clock, frames: range) -> Iterator[Mark]:
    """The convex hull of the feet in contact, red where the weight has left it."""
    rows = clock.rows[frames.start : frames.stop]
    hulls = support_polygons(walk.contact_point[rows], walk.contact[rows])
    stable = walk.margin[rows] > 0
    for name, colour, chosen in (
        ("support polygon", palette.STABLE, stable),
        ("support polygon, tipping", palette.LIMIT, ~stable),
    ):
        outlines = {frames[i]: _corners(hulls[i]) for i in np.flatnonzero(chosen)}
        filled = polygons(outlines.values(), outlines)
        width = palette.EDGE * walk.reach
        edges = (
            ribbon(np.vstack([c, c[:1]]), np.full(len(c) + 1, frame), width)
            for frame, c in outlines.items()
        )
        yield Mark(name, join([filled], life=1), colour, alpha=0.25)
        yield Mark(f"edge of the {name}", join(edges, life=1), colour)


def _corners(hull: shapely.Geometry) -> Array:
    """Corners of a polygon, anticlockwise; ends of a segment; shape (n, 2)."""
    if isinstance(hull, shapely.Polygon):
        return shapely.get_coordinates(shapely.orient_polygons(hull))[:-1]
    return shapely.get_coordinates(hull)


def swept(robot: Solids, walk: Run, clock: Clock) -> Drawing:
    """All that the robot has stood over, growing with the frames."""
    parts = shapely.union_all(robot.covered(walk.qpos[clock.rows]), axis=0)
    done, pieces = shapely.Polygon(), []
    for frame, shape in enumerate(shapely.simplify(parts, FINENESS * walk.reach)):
        fresh = shapely.get_parts(shapely.difference(shape, done))
        flat = shapely.MultiPolygon([p for p in fresh if p.area])
        parted = shapely.constrained_delaunay_triangles(flat)
        corners = shapely.get_coordinates(shapely.orient_polygons(parted))
        triangles = corners.reshape(-1, 4, 2)[:, :3]  # closed ones, anticlockwise
        pieces.append(polygons(triangles, np.full(len(triangles), frame)))
        done = shapely.union(done, shape)
    return join(pieces)
