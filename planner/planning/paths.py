"""Nominal paths gamma: configurations as a function of s in [0, 1] (Sec. 5.2, step 2).

Angles are continuous along a path and are never wrapped.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import message
from planner.numerics.arrays import Array, reals

COLUMNS = ("x", "y", "yaw")  # [m], [m], [rad]
HALVINGS = 40  # of a step in which a curve may jump
MOST_PIECES = 5000  # of a curve whose length is found, or four times its own
ROMBERG = np.array([-1, 84, -1344, 4096]) / 2835  # for lengths of 1, 2, 4 and 8 chords


@dataclass(frozen=True, eq=False)
class Path:
    """A curve through configurations.

    Attributes:
        at: Maps parameters of shape (k,) to configurations of shape (k, n).
        corners: Parameters in (0, 1) where the direction jumps, ascending.

    Example:
        >>> from planner import line
        >>> line((0, 0), (1, 2))(0.5)
        array([0.5, 1. ])
    """

    at: Callable[[Array], Array]
    corners: tuple[float, ...] = ()

    def __call__(self, s: float) -> Array:
        """The configuration at one parameter, shape (n,)."""
        return self.at(reals([s], "parameters"))[0]


def line(start: ArrayLike, goal: ArrayLike) -> Path:
    """The straight line between two configurations (Figs. 6 and 8).

    Example:
        >>> from planner import line
        >>> line((0, 0), (1, 2))(0.5)
        array([0.5, 1. ])
    """
    return waypoints([start, goal])


def ellipse_perimeter(semi_axes: Sequence[float]) -> float:
    """Length of an ellipse once around, in the unit of its semi-axes."""
    from sympy import elliptic_e  # slow to import, and seldom needed

    minor, major = sorted(semi_axes)
    return 4 * major * float(elliptic_e(1 - (minor / major) ** 2))


def waypoints(points: Sequence[ArrayLike]) -> Path:
    """Straight lines from each configuration to the next, s proportional to length.

    At least two configurations are given, of equal size; repetitions are ignored.

    Raises:
        ValueError: Fewer than two points, unequal sizes, or values not finite.

    Example:
        >>> from planner import waypoints
        >>> waypoints([(0, 0), (1, 0), (1, 1)]).corners
        (0.5,)
    """
    if len(points) < 2:
        raise ValueError(f"a path needs at least 2 points, got {len(points)}")
    knots, where = _by_length(_configurations(points))
    if len(knots) == 1:
        return Path(lambda s: np.repeat(knots, s.size, axis=0))

    def at(s: Array) -> Array:
        k = np.clip(np.searchsorted(where, s, side="right") - 1, 0, len(where) - 2)
        part = ((s - where[k]) / (where[k + 1] - where[k]))[:, None]
        return (1 - part) * knots[k] + part * knots[k + 1]

    return Path(at, tuple(where[1:-1].tolist()))


def _by_length(points: Array) -> tuple[Array, Array]:
    """Points (k, n) without repetitions, and the share of the length at each, (k,)."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    moved = lengths > 2 * np.finfo(float).eps * lengths.sum()
    points = points[np.append(True, moved)]
    where = np.linspace(0.0, 1.0, len(points))
    where[1:-1] = np.cumsum(lengths[moved])[:-1] / lengths.sum()
    return points, where


def ellipse(start: ArrayLike, semi_axes: tuple[float, float]) -> Path:
    """A whole ellipse in the first two coordinates, with the others constant (Fig. 7).

    The path is start + (a cos 2 pi s - a, b sin 2 pi s, 0, ...) with the semi-axes a
    and b. At the start it moves along the second coordinate.

    Raises:
        ValueError: The configuration has fewer than two coordinates or is not finite.

    Example:
        >>> from planner import ellipse
        >>> ellipse((0, 0), (2, 1))(0.25)
        array([-2.,  1.])
    """
    (origin,) = _configurations([start])
    if origin.size < 2:
        raise ValueError(f"an ellipse needs two coordinates, got {origin.size}")
    a, b = semi_axes

    def at(s: Array) -> Array:
        configurations = np.repeat(origin[None], s.size, axis=0)
        turn = 2 * np.pi * s
        configurations[:, 0] += a * np.cos(turn) - a
        configurations[:, 1] += b * np.sin(turn)
        return configurations

    return Path(at)


def as_path(path: Path | Callable[[float], ArrayLike]) -> Path:
    """A function of s as a path; it is called once for each parameter."""
    if isinstance(path, Path):
        return path
    if not callable(path):
        raise ValueError(f"path is {path!r}; give a function of s in [0, 1], or a Path")
    return Path(lambda s: np.array([np.array(path(float(t)), float) for t in s]))


def grid(path: Path, segments: int) -> Array:
    """Parameters that divide a path into segments uniformly, except at its corners.

    Each corner takes the place of the nearest inner division, in such a way that every
    other corner finds one as well. If there are fewer divisions than corners, they are
    uniform and the corners are cut.
    """
    parameters = np.linspace(0.0, 1.0, segments + 1)
    corners = np.array(path.corners)
    spare = segments - 1 - corners.size
    if spare >= 0:
        # divisions that each corner leaves to others, and its own
        before = np.arange(1, corners.size + 1)
        later = np.clip(np.rint(corners * segments) - before, 0, spare)
        parameters[np.maximum.accumulate(later).astype(int) + before] = corners
    return parameters


def recut(path: Path, cuts: Array) -> Path:
    """The same curve, with the same range of s for each piece between given parameters.

    A uniform division of the new path divides the given one at the cuts, which ascend
    from 0 to 1. Corners between the cuts are not corners of the new path.
    """
    even = np.linspace(0.0, 1.0, len(cuts))
    kept = even[np.isin(cuts, path.corners)]
    return Path(lambda s: path.at(np.interp(s, even, cuts)), tuple(kept.tolist()))


def _configurations(points: Sequence[ArrayLike]) -> Array:
    rows = [reals(point, "coordinates") for point in points]
    for k, row in enumerate(rows):
        if row.ndim != 1 or row.shape != rows[0].shape:
            facts = {"number": k + 1, "shape": row.shape, "first": rows[0].shape}
            raise ValueError(message("uneven", **facts))
        if not np.isfinite(row).all():
            raise ValueError(f"point {k + 1} is not finite: {row.tolist()}")
    return np.array(rows)


def formula_curve(formulas: Mapping[str, object]) -> tuple[Path, float]:
    """Poses x(s), y(s), yaw(s) for s in [0, 1], and the arc length [m].

    Formulas or numbers have the names of `COLUMNS`; those missing are 0.
    """
    given = [formulas.get(name, 0) for name in COLUMNS]
    for name, text in zip(COLUMNS, given, strict=True):
        if isinstance(text, bool) or not isinstance(text, str | int | float):
            raise ValueError(f"{name} is {text!r}; write a formula of s")
    return _formula_curve(*map(str, given))


@lru_cache(maxsize=100)  # all points of a sweep have the same as a rule
def _formula_curve(*texts: str) -> tuple[Path, float]:
    from planner.systems.formulas import real_formula  # slow to import, seldom needed

    read = [real_formula(text, "s") for text in texts]

    def at(parameters: Array) -> Array:
        return np.stack([coordinate(parameters) for coordinate in read], axis=-1)

    places = np.linspace(0.0, 1.0, 1001)
    poses = at(places)
    finite = np.isfinite(poses).all(axis=1)
    if not finite.all():
        raise ValueError(f"not finite at s = {places[~finite][0]:.4g}; keep it finite")
    if (poses == poses[0]).all():
        raise ValueError("all poses are the same; let x, y or yaw change with s")
    steps = np.abs(np.diff(poses, axis=0))
    for axis, k in enumerate(steps.argmax(axis=0)):  # jumps stay as large in between
        ends, step = places[k : k + 2], 0.0
        for _ in range(HALVINGS):
            low, high = ends
            ends = np.array([low, (low + high) / 2, high])
            parts = np.abs(np.diff(at(ends)[:, axis]))
            ends, step = ends[parts.argmax() :][:2], parts.max()
        if step > steps[k, axis] / 2 > 0.0:
            raise ValueError(message("jumps", name=COLUMNS[axis], place=ends[0]))
    return Path(at), _arc_length(at, places)


def table_curve(poses: Sequence[Sequence[float]]) -> tuple[Path, float]:
    """A smooth curve through poses, and the arc length [m].

    Between the poses (k, 3) each coordinate is a cubic that does not overshoot, s by
    the length travelled; so dense tables have no corners.
    """
    from scipy.interpolate import PchipInterpolator

    knots, where = _by_length(np.array(poses, dtype=float))
    if len(knots) < 2:
        raise ValueError("all poses are the same; give at least two different ones")
    spline = PchipInterpolator(where, knots)
    return Path(spline), _arc_length(spline, where)


@np.errstate(all="ignore")
def _arc_length(curve: Callable[[Array], Array], cuts: Array) -> float:
    """By chords, which are extrapolated, and halved wherever halves say otherwise."""

    def lengths(starts: Array, widths: Array) -> Array:
        places = starts[:, None] + np.outer(widths, np.linspace(0.0, 1.0, 9))
        points = curve(places.ravel())[:, :2].reshape(*places.shape, 2)
        chords = [np.diff(points[:, ::step], axis=1) for step in (8, 4, 2, 1)]
        return ROMBERG @ [np.hypot(*np.moveaxis(c, -1, 0)).sum(axis=1) for c in chords]

    starts, widths, known = cuts[:-1], np.diff(cuts), 0.0
    whole = lengths(starts, widths)
    precision = 1e-12 * whole[np.isfinite(whole)].sum()  # of the length
    most = max(MOST_PIECES, 4 * len(cuts))
    for _ in range(HALVINGS):
        starts = np.stack([starts, starts + widths / 2], axis=1).ravel()
        widths = np.repeat(widths / 2, 2)
        halves = lengths(starts, widths)
        both = halves.reshape(-1, 2).sum(axis=1)
        off = ~(np.abs(both - whole) <= precision * 2 * widths[::2])
        known += both[~off].sum()
        parts = np.repeat(off, 2)
        starts, widths, whole = starts[parts], widths[parts], halves[parts]
        if not 0 < len(starts) < most:
            break
    return float(known + whole[np.isfinite(whole)].sum())  # but where it is undefined
