"""Clearance of a walk from obstacles, in the physics and by every prediction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from planner import Array
from sim.motion.prediction import Prediction
from sim.obstacles.clearance import surroundings
from sim.walking.finished import Walk


def clearances(walk: Walk, predicted: Mapping[str, Prediction]) -> dict[str, Array]:
    """Clearance of the robot's outline at every moment, shape (T,) each [m].

    Args:
        walk: A finished walk.
        predicted: Its predictions, by name.

    Returns:
        That of `achieved` and of every prediction; empty without obstacles.
    """
    if not walk.setup.scenario.obstacles:
        return {}
    around = surroundings(walk.setup)
    angles = commanded(walk)
    found = {"achieved": around.clearances(walk.recording.moments.qpos).least}
    for name, prediction in predicted.items():
        qpos = around.outline.configurations(prediction.pose, *angles)
        found[name] = around.clearances(qpos).least
    return found


def commanded(walk: Walk) -> tuple[Array, Array]:
    """Commanded swing and lift of every group at every moment, shape (T, G) each."""
    step = walk.recording.during
    angles = []
    for stretch in walk.stretches:
        schedule = stretch.schedule
        inside = step[(step >= schedule.start) & (step < schedule.stop)]
        angles.append(schedule.angles(inside - schedule.start))
    swing, lift = map(np.concatenate, zip(*angles, strict=True))
    return swing, lift
