"""Where the camera stands: the whole walk in view, its long side across the picture.

For walks much longer than the robot the camera stays close and follows. Pure geometry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from sim.film_clock import Clock
from sim.film_style import FRAME_RATE, HEIGHT, WIDTH
from sim.film_walk import Walk

Array = np.ndarray

FIELD_OF_VIEW = 32.0  # vertical [degrees]; narrow, for calm perspective
ELEVATION = -50.0  # [degrees]
SWAY = 7.0  # [degrees] to either side in the course of the film
MARGINS = (0.86, 0.70)  # of the half picture, sideways and upright, left for captions
BODY_HEIGHT = 0.5  # in units of the robot's reach
FARTHEST = 7.0  # in units of the robot's reach; beyond, the camera follows
CALM = 1.5  # [s] of film over which the camera follows


@dataclass(frozen=True)
class Camera:
    """A view for each frame."""

    target: Array  # point in the centre of the picture, (frames, 3) [m]
    azimuth: Array  # (frames,) [degrees]
    distance: float  # from the target [m]
    elevation: float = ELEVATION  # [degrees]


def camera(walk: Walk, clock: Clock) -> Camera:
    """The camera of a whole film."""
    seen = _seen(walk)
    azimuth = _across(walk.nominal) + SWAY * np.sin(np.linspace(-np.pi / 2, np.pi / 2, len(clock.rows)))
    centre = (seen.min(axis=0) + seen.max(axis=0)) / 2
    fitting = max(_distance(seen - centre, a) for a in (azimuth[0], azimuth[-1]))
    farthest = FARTHEST * walk.reach
    follow = 1 - min(1.0, farthest / fitting)
    robot = walk.achieved[clock.rows] * (1, 1, 0)
    calm = gaussian_filter1d(robot, CALM * FRAME_RATE, axis=0, mode="nearest")
    return Camera(centre + follow * (calm - centre), azimuth, min(fitting, farthest))


def _seen(walk: Walk) -> Array:
    """Points that the picture should hold, shape (N, 3)."""
    floor = (walk.contact_point[walk.contact], walk.nominal[:, :2])
    height = BODY_HEIGHT * walk.reach
    body = np.insert(walk.achieved[:, :2], 2, height, axis=1)
    return np.concatenate([body, *(np.insert(points, 2, 0.0, axis=1) for points in floor)])


def _across(path: Array) -> float:
    """Azimuth that puts the longest extent of a path across the picture [degrees]."""
    plane = path[:, :2] - path[:, :2].mean(axis=0)
    x, y = np.linalg.eigh(plane.T @ plane)[1][:, -1]
    angle = np.arctan2(y, x) if x >= 0 else np.arctan2(-y, -x)
    return float(np.degrees(angle)) + 90.0


def _distance(points: Array, azimuth: float) -> float:
    """Smallest distance at which points around the target are inside the margins [m]."""
    turn, tilt = np.radians(azimuth), np.radians(ELEVATION)
    forward = np.array(
        [np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)]
    )
    right = np.array([np.sin(turn), -np.cos(turn), 0.0])
    up = np.cross(right, forward)
    upright = np.tan(np.radians(FIELD_OF_VIEW) / 2)
    sideways = upright * WIDTH / HEIGHT
    depth = points @ forward
    across = np.abs(points @ right) / (MARGINS[0] * sideways) - depth
    along = np.abs(points @ up) / (MARGINS[1] * upright) - depth
    return float(max(across.max(), along.max()))
