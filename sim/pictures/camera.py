"""The camera: the whole walk is in view, with its long side across the picture.

On walks that are much longer than the robot, the camera stays close and follows it.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from planner import Array
from planner.support import did_you_mean, shipped_tables
from sim.errors import UsageError
from sim.pictures.clock import FRAME_RATE, Clock
from sim.runs.run import Run

WIDTH, HEIGHT = 1280, 720  # of the picture [pixels]; even, as the codec demands
FIELD_OF_VIEW = 32.0  # vertical [degrees]; narrow, for calm perspective
FREE = (356, 24, 1244, 580)  # left, top, right, bottom for what is seen [pixels]
USED = ((FREE[2] - FREE[0]) / WIDTH, (FREE[3] - FREE[1]) / HEIGHT)  # of the picture
MIDDLE = ((FREE[0] + FREE[2]) / WIDTH - 1, 1 - (FREE[1] + FREE[3]) / HEIGHT)  # of it
HALF_HEIGHT = float(np.tan(np.radians(FIELD_OF_VIEW) / 2))  # of the picture, at 1 m
HALF_WIDTH = HALF_HEIGHT * WIDTH / HEIGHT
NEAR_FLOOR = 3.5  # in units of the distance; beyond, a grid would be a blur
ENOUGH = 2000  # moments at which it is asked what has to be seen
ELEVATION = -50.0  # [degrees]
VIEW_DISTANCE = 7.0  # in units of the robot's reach; beyond, the camera follows
STEEPEST, FLATTEST = -89.9, -5.0  # [degrees]; the floor hides all from below
CALM = 1.5  # [s] of film over which the camera follows


@dataclass(frozen=True, slots=True)
class View:
    """From where a film is taken; one that is too close for all follows the robot."""

    azimuth: float | None = None  # 0 looks along x [degrees]; None across the path
    elevation: float = ELEVATION  # below the horizon, negative [degrees]
    farthest: float = VIEW_DISTANCE  # distance, in units of the robot's reach


FILM = shipped_tables("sim.pictures", "film.toml")
VIEWS = {name: View(**view) for name, view in FILM["views"].items()}
ACROSS = VIEWS["across"]


def view_of(text: str) -> View:
    """The view of a name, or of two angles in degrees, `AZIMUTH,ELEVATION`."""
    if text in VIEWS:
        return VIEWS[text]
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        remedy = f"{did_you_mean(text, [*VIEWS])}; or give AZIMUTH,ELEVATION in degrees"
        raise UsageError(f"unknown camera {text!r}", "film", remedy) from None
    if not (math.isfinite(azimuth) and -90 <= elevation <= FLATTEST):
        raise UsageError.of("sees_no_floor", "film", text=text, FLATTEST=FLATTEST)
    return View(azimuth, max(elevation, STEEPEST))


@dataclass(frozen=True)
class Camera:
    """A view for each frame."""

    target: Array  # point in the centre of the picture, (frames, 3) [m]
    azimuth: Array  # (frames,) [degrees]
    distance: float  # from the target [m]
    elevation: float = ELEVATION  # [degrees]
    pixel: ClassVar[float] = 2 * HALF_HEIGHT / HEIGHT  # width, a metre away [m]

    def rests(self, frame: int) -> bool:
        """Whether a frame is seen from where the frame before it was."""
        before, seen = max(frame - 1, 0), (self.target, self.azimuth)
        return all(np.array_equal(a[frame], a[before]) for a in seen)

    def eyes(self) -> Array:
        """Where the camera is in each frame, shape (frames, 3) [m]."""
        return self.target - self.distance * _axes(self.azimuth, self.elevation)[0]

    def floor_seen(self) -> tuple[Array, Array]:
        """Least and largest x and y of the floor in view, as far as it is near [m]."""
        forward, right, up = _axes(self.azimuth, self.elevation)
        eyes, ground = self.eyes(), []
        for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            ray = forward + x * HALF_WIDTH * right + y * HALF_HEIGHT * up
            steep = np.minimum(ray[:, 2], -1e-6)
            far = np.minimum(-eyes[:, 2] / steep, NEAR_FLOOR * self.distance)
            ground.append((eyes + far[:, None] * ray)[:, :2])
        points = np.concatenate(ground)
        return points.min(axis=0), points.max(axis=0)

    def pixels(self, frame: int, points: Array) -> Array:
        """Where points, (..., 3) [m], appear in a picture, from its left and top."""
        forward, right, up = _axes(self.azimuth[frame], self.elevation)
        seen = points - self.target[frame]
        depth = (self.distance + seen @ forward) * self.pixel
        x, y = seen @ right / depth, seen @ up / depth
        return np.stack([WIDTH / 2 + x, HEIGHT / 2 - y], axis=-1)


def camera(walk: Run, clock: Clock, view: View = ACROSS) -> Camera:
    """The camera of a whole film."""
    looks = _across(walk.nominal) if view.azimuth is None else view.azimuth
    azimuth, elevation = np.full(len(clock.rows), looks), view.elevation
    centre, fitting = _fit(_seen(walk, clock), looks, elevation)
    distance = min(fitting, view.farthest * walk.reach)
    follow = min(1.0, 2 * (1 - distance / fitting))  # leaves room for the robot itself
    if follow > 0:  # the body's way over the floor, without its quick motion
        from scipy.ndimage import gaussian_filter1d  # slow to import, and seldom needed

        body = np.insert(walk.achieved[clock.rows, :2], 2, 0.0, axis=1)
        calm = gaussian_filter1d(body, CALM * FRAME_RATE, axis=0, mode="nearest")
        centre = centre + follow * (calm - centre)
    _, right, up = _axes(azimuth, elevation)
    aside = (MIDDLE[0] * HALF_WIDTH * right + MIDDLE[1] * HALF_HEIGHT * up) * distance
    return Camera(centre - aside, azimuth, distance, elevation)


def _seen(walk: Run, clock: Clock) -> Array:
    """Points that the picture should hold: feet, knees and path, shape (N, 3)."""
    first, last = int(clock.rows[0]), int(clock.rows[-1])
    shown = slice(first, last + 1, max(1, (last - first) // ENOUGH))
    feet = np.concatenate(walk.contact_point[shown])
    whole = first == 0 and last == len(walk.contact) - 1
    path = walk.nominal if whole else walk.achieved[shown]
    heights = ((feet, 0.0), (feet, 0.35 * walk.reach), (path[:, :2], 0.0))  # knees
    return np.concatenate([np.insert(points, 2, z, axis=1) for points, z in heights])


def _across(path: Array) -> float:
    """Azimuth that puts the longest extent of a path across the picture [degrees]."""
    plane = path[:, :2] - path[:, :2].mean(axis=0)
    x, y = np.linalg.eigh(plane.T @ plane)[1][:, -1]
    return float(np.degrees(np.arctan2(y, x) if x >= 0 else np.arctan2(-y, -x))) + 90.0


def _fit(points: Array, azimuth: float, elevation: float) -> tuple[Array, float]:
    """Target and distance with which the points just fill the picture's margins."""
    forward, right, up = _axes(azimuth, elevation)
    target = points.mean(axis=0)
    for _ in range(8):  # of moving the target; settles to a pixel
        seen = points - target
        across = np.abs(seen @ right) / (USED[0] * HALF_WIDTH)
        upright = np.abs(seen @ up) / (USED[1] * HALF_HEIGHT)
        distance = float((np.maximum(across, upright) - seen @ forward).max())
        depth = distance + seen @ forward
        for axis in (right, up):
            slope = (seen @ axis) / depth
            target = target + (slope.min() + slope.max()) / 2 * distance * axis
    return target, distance


def _axes(azimuth: Array | float, elevation: float) -> tuple[Array, Array, Array]:
    """Directions forward, right and up of the picture, shape (..., 3) each."""
    turn, tilt = np.radians(azimuth), np.radians(elevation)
    cos, sin, level = np.cos(turn), np.sin(turn), np.zeros_like(turn)
    forward = (cos * np.cos(tilt), sin * np.cos(tilt), level + np.sin(tilt))
    up = (-cos * np.sin(tilt), -sin * np.sin(tilt), level + np.cos(tilt))
    return np.stack(forward, -1), np.stack((sin, -cos, level), -1), np.stack(up, -1)
