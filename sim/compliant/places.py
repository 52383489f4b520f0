"""Where the parts of a robot are at given angles, and how its joints move its feet."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim.compliant.anatomy import Anatomy, Robots

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Places:
    """Parts of lanes' robots about the root, in the world's directions."""

    arm: Array  # points that may touch the floor, (B, F, K, 3) [m]
    anchor: Array  # of every hinge, (B, F, J, 3) [m]
    axis: Array  # (B, F, J, 3)
    link: Array  # centres of mass, (B, F, J, 3) [m]
    center: Array  # of mass of the whole robot, (B, 3) [m]

    @cached_property
    def lever(self) -> Array:
        """Motion of the points by the joints, (B, F, 3 K, J) [m/rad]."""
        spoke = self.arm[:, :, :, None] - self.anchor[:, :, None]  # (B, F, K, J, 3)
        rows = np.swapaxes(cross(self.axis[:, :, None], spoke), 3, 4)
        return rows.reshape(*rows.shape[:2], -1, rows.shape[4])

    @property
    def reach(self) -> Array:
        """Motion of the points by the body's twist, (B, F, 3 K, 6)."""
        moved = np.broadcast_to(np.eye(3), (*self.arm.shape, 3))
        G = np.concatenate([moved, -skew(self.arm)], axis=-1)
        return G.reshape(*G.shape[:2], -1, 6)

    def weight_torque(self, anatomy: Anatomy, gravity: Array) -> Array:
        """Torque of what hangs on every joint about it, (B, F, J) [N m]."""
        beyond = np.triu(np.ones(2 * self.link.shape[2:3]))  # this hinge and later ones
        mass = anatomy.link_mass
        moment = beyond @ (mass[..., None] * self.link)
        moment = moment - (mass @ beyond.T)[..., None] * self.anchor
        turned = cross(moment, np.broadcast_to(gravity[:, None, None], moment.shape))
        return (self.axis * turned).sum(axis=-1)


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Forward kinematics of an anatomy for any number of lanes."""

    anatomy: Anatomy

    @cached_property
    def _turning(self) -> tuple[Array, Array]:
        """Rodrigues' matrices of every hinge: of its sine and its cosine."""
        K = skew(self.anatomy.axis)
        return K, K @ K

    @cached_property
    def _offsets(self) -> tuple[Array, Array, Array]:
        """From hinge to hinge, to the links' centres, and from the last to the sole."""
        a = self.anatomy
        steps = np.diff(a.anchor, axis=1)
        return steps, a.link_center - a.anchor, a.sole - a.anchor[:, -1:]

    def places(self, robots: Robots, turned: Array, angles: Array) -> Places:
        """Places for rotations (B, 3, 3) of the root and angles (B, F, J) [rad]."""
        a, (sine, cosine) = self.anatomy, self._turning
        steps, to_center, to_sole = self._offsets
        by = (angles - a.start)[..., None, None]
        turns = np.eye(3) + np.sin(by) * sine + (1 - np.cos(by)) * cosine
        lanes, (feet, hinges) = len(angles), a.start.shape
        anchors = np.empty((lanes, feet, hinges, 3))
        axes, links = np.empty_like(anchors), np.empty_like(anchors)
        anchors[:, :, 0], axes[:, :, 0] = a.anchor[:, 0], a.axis[:, 0]
        frame = turns[:, :, 0]
        for j in range(hinges):
            if j:
                anchors[:, :, j] = anchors[:, :, j - 1] + _apply(frame, steps[:, j - 1])
                axes[:, :, j] = _apply(frame, a.axis[:, j])
                frame = frame @ turns[:, :, j]
            links[:, :, j] = anchors[:, :, j] + _apply(frame, to_center[:, j])
        soles = anchors[:, :, -1:] + to_sole @ np.swapaxes(frame, 2, 3)
        parts = (soles, anchors, axes, links)
        rows = np.concatenate(parts, axis=2).reshape(lanes, -1, 3)
        world = (rows @ np.swapaxes(turned, 1, 2)).reshape(lanes, feet, -1, 3)
        cuts = a.sole.shape[1] + hinges * np.arange(3)
        sole, anchor, axis, link = np.split(world, cuts, axis=2)
        body = (turned @ robots.body_center[..., None])[..., 0]
        moment = (a.link_mass[..., None] * link).sum(axis=(1, 2))
        center = (robots.body_mass[:, None] * body + moment) / robots.mass[:, None]
        return Places(sole - robots.radius[..., None] * UP, anchor, axis, link, center)


def _apply(frames: Array, vectors: Array) -> Array:
    """Rotations (B, F, 3, 3) of a vector a foot, (F, 3)."""
    return (frames @ vectors[..., None])[..., 0]


def cross(a: Array, b: Array) -> Array:
    """Cross products over the last axis; numpy's own takes several times as long."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def skew(v: Array) -> Array:
    """Matrices (..., 3, 3) of the cross product with vectors (..., 3)."""
    K = np.zeros((*v.shape, 3))
    K[..., 0, 1], K[..., 0, 2], K[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return K - np.swapaxes(K, -1, -2)


def rotation(v: Array) -> Array:
    """Matrices of rotation vectors, (..., 3) to (..., 3, 3)."""
    square = (v * v).sum(axis=-1)[..., None, None]
    angle = np.sqrt(square)
    small = angle < 1e-4  # [rad], below which a rotation is a polynomial
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1 - square / 6, np.sin(safe) / safe)
    cosine = np.where(small, 0.5 - square / 24, (1 - np.cos(safe)) / safe**2)
    K = skew(v)
    return np.eye(3) + sine * K + cosine * (K @ K)
