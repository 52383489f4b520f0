"""What is drawn into the viewer's scene: paths, ghost, support polygon, footprints."""

from collections.abc import Iterator
from itertools import islice, pairwise

import mujoco
import numpy as np
import shapely

from planner import Array
from sim import palette
from sim.motion.poses import length_up_to
from sim.motion.stability import support_polygons
from sim.palette import EDGE, FOOTPRINT, GOAL, NOMINAL, SPOT, Colour
from sim.pictures.ghost import Ghost, decor
from sim.runs.run import Run

KIND = mujoco.mjtGeom
TORSO = 0.35  # opacity of the body, so that the paths below are seen
BEND = 0.2  # of a path's width: the same line in fewer rods, each of them costs time
# In units of the robot's reach.
HIGH, THICK = 0.008, 0.006  # above the floor, width of paths


class Marks:
    """The marks of one walk, row by row."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._walk = walk
        *_, last = walk.drawn
        self._ghost = Ghost(walk, model, last)
        self._still = list(self._unmoved())
        self._prints = _uncovered(walk, *landings(walk))
        self._shown: tuple[int, list[mujoco.MjvGeom]] = -1, []

    def at(self, row: int) -> list[mujoco.MjvGeom]:
        """All marks of a row, as MuJoCo draws them."""
        if row != self._shown[0]:
            come = self._bent(self._walk.achieved[: row + 1])
            achieved = self._line(come, palette.ACHIEVED.colour, THICK, level=3)
            still = (*self._still, *self._footprints(row))
            moving = (*achieved, *self._support(row), *self._ghost.at(row))
            self._shown = row, [*still, *moving]
        return self._shown[1]

    def _bent(self, poses: Array) -> Array:
        """A path in as few points as it looks the same with."""
        points = thinned(poses[:, :2])
        if len(points) < 3:
            return points
        apart = BEND * THICK * self._walk.reach
        return shapely.get_coordinates(shapely.LineString(points).simplify(apart))

    def _unmoved(self) -> Iterator[mujoco.MjvGeom]:
        """Paths, where the robot was thought to be, and the goal."""
        walk = self._walk
        nominal = thinned(walk.nominal[:, :2])
        yield from self._line(nominal, NOMINAL.colour, THICK, level=0, step=2)
        for level, (name, poses) in enumerate(walk.drawn.items(), start=1):
            colour = palette.PREDICTED[name].colour
            yield from self._line(self._bent(poses), colour, THICK, level)
        for outline in walk.thought:
            yield from self._line(outline, palette.THOUGHT.colour, THICK / 2, level=3)
        place = np.append(walk.nominal[-1, :2], HIGH * walk.reach / 2)
        size = np.array([GOAL, HIGH / 4, 0.0]) * walk.reach
        yield decor(KIND.mjGEOM_CYLINDER, size, place, NOMINAL.colour.rgba(0.5))

    def _line(
        self, points: Array, colour: Colour, width: float, level: int, step: int = 1
    ) -> Iterator[mujoco.MjvGeom]:
        """Thin bars from point to point, a little above the floor; rods take longer."""
        reach = self._walk.reach
        places = np.insert(points, 2, HIGH * reach * (1 + 0.3 * level), axis=1)
        for start, end in islice(pairwise(places), 0, None, step):
            geom = decor(KIND.mjGEOM_CYLINDER, np.ones(3), start, colour.rgba())
            radius = width * reach / 2
            mujoco.mjv_connector(geom, KIND.mjGEOM_CYLINDER, radius, start, end)
            geom.type = KIND.mjGEOM_BOX  # of the same place and size
            yield geom

    def _footprints(self, row: int) -> Iterator[mujoco.MjvGeom]:
        rows, feet = self._prints
        stop = int(np.searchsorted(rows, row, side="right"))
        size = np.array([FOOTPRINT, HIGH / 4, 0.0]) * self._walk.reach
        for i in range(max(stop - 120, 0), stop):  # the viewer draws 1024 geoms
            foot = int(feet[i])
            place = np.append(self._walk.contact_point[rows[i], foot], size[1])
            colour = palette.footprint(self._walk.group_of_foot[foot]).rgba()
            yield decor(KIND.mjGEOM_CYLINDER, size, place, colour)

    def _support(self, row: int) -> Iterator[mujoco.MjvGeom]:
        """The edge of the support polygon, red where the weight has left it."""
        walk = self._walk
        yield from self._line(*support(walk, row), EDGE, level=4)
        place = np.append(walk.center_of_mass[row], 2 * HIGH * walk.reach)
        size = np.full(3, SPOT * walk.reach)
        yield decor(KIND.mjGEOM_SPHERE, size, place, palette.CENTRE_OF_MASS.rgba())


def support(walk: Run, row: int) -> tuple[Array, Colour]:
    """Edge of the support polygon, closed, shape (n, 2) [m], and its colour."""
    here = slice(row, row + 1)
    (hull,) = support_polygons(walk.contact_point[here], walk.contact[here])
    ring = hull.exterior if isinstance(hull, shapely.Polygon) else hull
    colour = palette.STABLE if walk.margin[row] > 0 else palette.LIMIT
    return shapely.get_coordinates(ring), colour


def landings(walk: Run) -> tuple[Array, Array]:
    """Rows in which a foot comes down, ascending, and which foot it is."""
    rows, feet = np.nonzero(np.diff(walk.contact.astype(int), axis=0, prepend=0) > 0)
    return rows, feet


def _uncovered(run: Run, rows: Array, feet: Array) -> tuple[Array, Array]:
    """The landings whose prints are not hidden by an earlier one of the same foot."""
    near, kept = 0.4 * FOOTPRINT * run.reach, []
    last: dict[int, list[Array]] = {}
    for i, (row, foot) in enumerate(zip(rows, feet, strict=True)):
        place, seen = run.contact_point[row, foot], last.setdefault(int(foot), [])
        if not seen or np.hypot(*(np.array(seen) - place).T).min() > near:
            seen.append(place)
            kept.append(i)
    return rows[kept], feet[kept]


def middle_and_extent(walk: Run) -> tuple[Array, float]:
    """Middle of the nominal path, (2,), and the longer side of its extent [m]."""
    path = walk.nominal[:, :2]
    return path.mean(axis=0), float(np.ptp(path, axis=0).max())


def thinned(points: Array) -> Array:
    """Points evenly apart along a line, the first and the last among them."""
    way = length_up_to(points)
    if not way[-1]:
        return points[:1]
    at = np.searchsorted(way, np.linspace(0, way[-1], 120))
    return points[np.unique(np.minimum(at, len(points) - 1))]
