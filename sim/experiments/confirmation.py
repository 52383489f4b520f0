"""Confirmation of measured fields by a stroke that was not used to measure them.

The stroke goes in the opposite direction and over the whole range of the joints. A
measured field is used as far as it predicts this stroke, and not beyond.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from models import MeasurementError
from models.motion import MeasuredField
from planner import Array
from sim.errors import SimulationError
from sim.motion.poses import relative
from sim.preparation.setup import Setup

TOLERATED = 0.2  # of a stroke's motion; up to 0.12 measured on shipped robots
FINE = 200  # parts of the way in which predictions are summed
Stroke = Callable[[float], tuple[Array, Array, float]]


def confirmed_reach(
    setup: Setup, field: MeasuredField, stroke: Stroke, farthest: float
) -> float:
    """The range in which a field predicts a stroke in the opposite direction [rad].

    Args:
        setup: Robot, world and limits.
        field: What was measured.
        stroke: Swings the field through the physics from minus its argument to it.
        farthest: Of the joint range [rad].

    Raises:
        MeasurementError: If the field does not even predict the stroke within its span.
    """
    way, pose = _stroke_back(stroke, (farthest, field.span))
    ways = np.linspace(0.0, np.abs(way).max(), FINE)
    share = _shares(setup, field, ways, way, pose)
    within = ways <= field.span
    if (worst := share[within].max()) > TOLERATED:
        raise MeasurementError(
            f"a stroke in the opposite direction departs from its prediction by "
            f"{100 * worst:.0f} % of its motion"
        )
    beyond = np.flatnonzero(share > TOLERATED)
    return float(ways[beyond[0] - 1] if len(beyond) else ways[-1])


def _stroke_back(stroke: Stroke, spans: tuple[float, ...]) -> tuple[Array, Array]:
    """The longest stroke that succeeds, its ways ascending."""
    for span in spans:
        try:
            way, pose, _ = stroke(-span)
        except (MeasurementError, SimulationError) as error:
            refusal = error
            continue
        order = np.argsort(way)
        return way[order], np.unwrap(pose[order], axis=0, period=2 * np.pi)
    raise MeasurementError(
        f"it could not be confirmed by a stroke in the opposite direction: {refusal}"
    )


def _shares(
    setup: Setup, field: MeasuredField, ways: Array, way: Array, pose: Array
) -> Array:
    """Largest miss up to each way, either side, as a share of the motion up to it."""
    arm = setup.kinematics.reach
    miss, motion = np.zeros(len(ways)), np.zeros(len(ways))
    for side in (-1, 1):
        at = np.stack([np.interp(side * ways, way, c) for c in pose.T], axis=1)
        reached = relative(at[0], at)
        foreseen = _integrated(field, side * ways)
        miss = np.maximum(miss, _size(reached - foreseen, arm))
        motion = np.maximum(motion, _size(foreseen, arm))
    total = np.maximum.accumulate(motion)
    total = np.maximum(total, total[np.searchsorted(ways, field.span / 2)])
    shares: Array = np.maximum.accumulate(miss) / np.where(total > 0, total, 1.0)
    return shares


def _size(poses: Array, arm: float) -> Array:
    size: Array = np.hypot(poses[:, 0], poses[:, 1]) + arm * np.abs(poses[:, 2])
    return size


def _integrated(field: MeasuredField, ways: Array) -> Array:
    """Poses along a field from way zero on, shape (T, 3)."""
    middle, step = (ways[1:] + ways[:-1]) / 2, np.diff(ways)
    forward, left, turn = np.moveaxis(field(middle), -1, 0)
    yaw = np.concatenate([[0.0], np.cumsum(turn * step)])
    along = (yaw[1:] + yaw[:-1]) / 2
    cos, sin = np.cos(along), np.sin(along)
    x = np.cumsum((forward * cos - left * sin) * step)
    y = np.cumsum((forward * sin + left * cos) * step)
    return np.stack([np.append(0.0, x), np.append(0.0, y), yaw], axis=1)


def with_reach(field: MeasuredField, reach: float) -> MeasuredField:
    """The field, usable so far and no farther."""
    return replace(field, reach=max(reach, field.span))
