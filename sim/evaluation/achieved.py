"""Achieved motion of a walk: poses, contacts, slip and stability margins."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim.motion.poses import rotate, seen_from
from sim.motion.stability import carrying, stability_margin
from sim.physics.recording import Moments
from sim.walking.finished import Walk


@dataclass(frozen=True)
class Achieved:
    """Motion in the physics at every recorded moment, relative to the start pose."""

    pose: Array  # (T, 3)
    slip: Array  # since the walk's start, (T, F) [m]
    contact: Array  # (T, F), bool
    point: Array  # where each foot touches, (T, F, 2) [m]
    center_of_mass: Array  # (T, 3) [m]
    moments: Moments  # in world coordinates

    @cached_property
    def margin(self) -> Array:
        """Stability margin, shape (T,) [m]."""
        points, center = self.moments.point, self.moments.center_of_mass
        feet = carrying(points, self.contact, center)
        return stability_margin(points, feet, center[:, :2])


def achieved_motion(walk: Walk) -> Achieved:
    """What a walk did at every recorded moment."""
    recording, moments = walk.recording, walk.recording.moments
    points, center = moments.point, moments.center_of_mass
    (x, y, yaw), before = walk.origin, recording.slip_after(walk.starts)
    on_floor = rotate(center[:, :2] - (x, y), -yaw)
    return Achieved(
        pose=seen_from(walk.origin, walk.setup.pose(moments.qpos)),
        slip=np.maximum(moments.slip - before, 0.0),
        contact=moments.contact,
        point=rotate(points - (x, y), -yaw),
        center_of_mass=np.concatenate([on_floor, center[:, 2:]], axis=1),
        moments=moments,
    )
