"""Planar poses (x, y, yaw): read from qpos, seen from another pose, compared."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def wrap(angle: Array | float) -> Array:
    """Angle in (-pi, pi]."""
    return -((np.pi - np.asarray(angle, dtype=float)) % (2 * np.pi) - np.pi)


def pose_of(qpos: Array, address: int) -> Array:
    """Planar pose of a free body.

    Args:
        qpos: Shape (..., nq).
        address: Where the free joint's seven numbers begin.

    Returns:
        Shape (..., 3): x, y [m], yaw [rad] in (-pi, pi].
    """
    w, x, y, z = np.moveaxis(qpos[..., address + 3 : address + 7], -1, 0)
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.concatenate([qpos[..., address : address + 2], yaw[..., None]], axis=-1)


def seen_from(origin: Array, pose: Array) -> Array:
    """Pose in the frame of another, shape (..., 3)."""
    moved = rotate(pose[..., :2] - origin[..., :2], -origin[..., 2])
    return np.concatenate([moved, wrap(pose[..., 2:] - origin[..., 2:])], axis=-1)


def rotate(points: Array, angle: Array | float) -> Array:
    """Points turned about the vertical, shape (..., 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def nearest_turn(yaw: float, to: float) -> float:
    """The yaw, up to full turns, that is closest to another one."""
    return float(to + wrap(yaw - to))
