"""Predictions followed along a walk: motion, slip, margin and clearance."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from models import TwistModel
from planner import Array
from sim.motion.poses import wrap
from sim.motion.prediction import Commanded, Prediction, Predictor, commanded
from sim.motion.stability import BLOCK
from sim.obstacles.clearance import surroundings
from sim.walking.finished import Stretch, Walk


def commands_along(walk: Walk, stretch: Stretch) -> Iterator[Commanded]:
    """The commands of a stretch at the moments recorded, in blocks."""
    schedule, during = stretch.schedule, walk.recording.during
    inside = during[(during >= schedule.start) & (during < schedule.stop)]
    local = inside - schedule.start  # a stretch's last step is always among them
    for rows in np.split(local, range(BLOCK, len(local), BLOCK)):
        yield commanded(schedule, rows, walk.setup.kinematics)


def predicted_along(
    walk: Walk,
    model: Callable[[], TwistModel],
    given: Sequence[Sequence[Commanded]],
) -> Prediction:
    """One prediction over all stretches, each from the pose it was planned from."""
    pieces: list[Prediction] = []
    twists = model()
    slipped, kinematics = np.zeros(len(walk.setup.robot.legs)), walk.setup.kinematics
    for stretch, blocks in zip(walk.stretches, given, strict=True):
        predict = Predictor(stretch.schedule, twists, kinematics, tuple(stretch.pose))
        for block in blocks:
            piece = predict.along(block)
            pose = np.concatenate([piece.pose[:, :2], wrap(piece.pose[:, 2:])], axis=1)
            slip = piece.slip + slipped
            pieces.append(Prediction(pose, slip, piece.margin, piece.contact))
        slipped = slip[-1]
    names = ("pose", "slip", "margin", "contact")
    return Prediction(*(np.concatenate([getattr(p, n) for p in pieces]) for n in names))


def clearances(walk: Walk, predicted: Mapping[str, Prediction]) -> dict[str, Array]:
    """Clearance of the robot's outline at every moment, shape (T,) each [m].

    That of what was achieved and of every prediction; empty without obstacles.
    """
    if not walk.setup.scenario.obstacles:
        return {}
    around = surroundings(walk.setup)
    angles = commanded_angles(walk)
    found = {"achieved": around.clearances(walk.recording.moments.qpos).least}
    for name, prediction in predicted.items():
        qpos = around.outline.configurations(prediction.pose, *angles)
        found[name] = around.clearances(qpos).least
    return found


def commanded_angles(walk: Walk) -> tuple[Array, Array]:
    """Commanded swing and lift of every group at every moment, shape (T, G) each."""
    step = walk.recording.during
    angles = []
    for stretch in walk.stretches:
        schedule = stretch.schedule
        inside = step[(step >= schedule.start) & (step < schedule.stop)]
        angles.append(schedule.angles(inside - schedule.start))
    swing, lift = map(np.concatenate, zip(*angles, strict=True))
    return swing, lift
