"""Planar poses (x, y, yaw): from qpos, composed, relative, and off their path."""

from typing import NamedTuple

import numpy as np

from planner import Array, Path
from planner.optimisation import deviation

POSE = ("x", "y", "yaw")  # [m], [m], [rad]
GROUPS = ((0, 1), (2,))


def wrap(angle: Array | float) -> Array:
    """Angle in (-pi, pi]."""
    return -((np.pi - np.asarray(angle, dtype=float)) % (2 * np.pi) - np.pi)


def pose_of(qpos: Array, address: int) -> Array:
    """Planar pose (..., 3) of a body whose free joint begins at an address in qpos."""
    w, x, y, z = np.moveaxis(qpos[..., address + 3 : address + 7], -1, 0)
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.concatenate([qpos[..., address : address + 2], yaw[..., None]], axis=-1)


def tilt(qpos: Array, address: int) -> Array:
    """Angle between the z axis of such a body and the vertical, shape (...,) [rad]."""
    _, x, y, _ = np.moveaxis(qpos[..., address + 3 : address + 7], -1, 0)
    return 2 * np.arcsin(np.minimum(np.hypot(x, y), 1.0))


def lean_of(qpos: Array, address: int) -> Array:
    """Roll and pitch of such a body, about its own axes, shape (..., 2) [rad]."""
    w, x, y, z = np.moveaxis(qpos[..., address + 3 : address + 7], -1, 0)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return np.stack([roll, np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))], axis=-1)


def seen_from(origin: Array, pose: Array) -> Array:
    """Pose in the frame of another, yaw wrapped, shape (..., 3)."""
    step = relative(origin, pose)
    return np.concatenate([step[..., :2], wrap(step[..., 2:])], axis=-1)


def compose(pose: Array, step: Array) -> Array:
    """The pose reached by a step given in the frame of a pose; yaw is not wrapped."""
    moved = pose[..., :2] + rotate(step[..., :2], pose[..., 2])
    return np.concatenate([moved, pose[..., 2:] + step[..., 2:]], axis=-1)


def relative(pose: Array, other: Array) -> Array:
    """The step from one pose to another, the inverse of `compose`; yaw not wrapped."""
    moved = rotate(other[..., :2] - pose[..., :2], -pose[..., 2])
    return np.concatenate([moved, other[..., 2:] - pose[..., 2:]], axis=-1)


def rotate(points: Array, angle: Array | float) -> Array:
    """Points turned about the vertical, shape (..., 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def trail(steps: Array) -> Array:
    """Poses (N + 1, 3) on a way of small steps (N, 3) in the body's frame."""
    yaw = np.append(0.0, np.cumsum(steps[:, 2]))
    ways = rotate(steps[:, :2], (yaw[1:] + yaw[:-1]) / 2)
    return np.column_stack([np.vstack([np.zeros(2), np.cumsum(ways, axis=0)]), yaw])


def length_up_to(points: Array) -> Array:
    """Length of a line (N, 2) from its first point to each, shape (N,)."""
    return np.cumsum(np.hypot(*np.diff(points, axis=0, prepend=points[:1]).T))


def spaced_rows(points: Array, spacing: float) -> Array:
    """Rows of the first of some points (N, 2), and of the next ones a spacing on."""
    return np.unique(np.floor(length_up_to(points) / spacing), return_index=True)[1]


class PathDeviation(NamedTuple):
    """Farthest from a path, and from its yaw."""

    position: float  # [m]
    yaw: float  # [rad]


def path_deviation(path: Path, poses: Array) -> PathDeviation:
    """Farthest that poses (T, 3) come from a path and from its yaw, both in order."""
    points = path.at(np.linspace(0.0, 1.0, 1001))[:, :3]
    followed = poses.copy()
    followed[:, 2] = np.unwrap(poses[:, 2])
    return PathDeviation(*deviation(followed, points, GROUPS))
