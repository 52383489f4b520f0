"""Motion along a walk, as achieved and as predicted: poses, slip, margin, clearance."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from models import TwistModel
from planner import Array
from sim.compliant.prediction import foreseen
from sim.logs.playing import Played, rigid
from sim.motion.poses import rotate, seen_from, wrap
from sim.motion.prediction import Commanded, Prediction, Predictor, commanded
from sim.motion.stability import BLOCK, carrying, stability_margin
from sim.obstacles.clearance import surroundings
from sim.physics.recording import Moments
from sim.scenarios.predictions import COMPLIANT
from sim.walking.finished import Stretch, Walk, laid_commands


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


def _recorded(walk: Walk, stretch: Stretch) -> Array:
    """Steps of a stretch from its own start on, at the moments recorded, (n,)."""
    schedule, during = stretch.schedule, walk.recording.during
    inside = during[(during >= schedule.start) & (during < schedule.stop)]
    return inside - schedule.start  # its last step is always among them


def commands_along(walk: Walk, stretch: Stretch) -> Iterator[Commanded]:
    """The commands of a stretch at the moments recorded, in blocks."""
    local, schedule = _recorded(walk, stretch), stretch.schedule
    for rows in np.split(local, range(BLOCK, len(local), BLOCK)):
        if isinstance(schedule, Played):
            yield schedule.commanded(rows, walk.setup.kinematics)
        else:
            yield commanded(schedule, rows, walk.setup.kinematics)


def predicted_along(
    walk: Walk,
    name: str,
    model: Callable[[], TwistModel],
    given: Sequence[Sequence[Commanded]],
) -> Prediction:
    """A prediction over all stretches, from their commands at the moments recorded."""
    every = [block for stretch in given for block in stretch]
    contact = np.concatenate([block.contact for block in every])
    if name == COMPLIANT.key:
        known, moments = walk.setup.as_known, walk.recording.moments
        rows = laid_commands(known, walk.stretches, walk.steps)
        times = moments.step * walk.setup.limits.timestep
        found = foreseen(known, walk.stretches, rows, times, contact)
        before = found.slip[moments.step.searchsorted(walk.starts)]
        return replace(found, slip=np.maximum(found.slip - before, 0.0))
    if (motion := walk.setup.motion) is not None:
        margin = np.concatenate([block.margin for block in every])
        return rigid(motion, walk.setup.ground, contact, margin, time_of(walk))
    twists, kinematics = model(), walk.setup.kinematics
    slipped = np.zeros(len(walk.setup.robot.legs))
    pieces: list[tuple[Array, Array, Array, Array]] = []
    for stretch, blocks in zip(walk.stretches, given, strict=True):
        predict = Predictor(stretch.schedule, twists, kinematics, tuple(stretch.pose))
        for block in blocks:
            piece = predict.along(block)
            slip = piece.slip + slipped
            pieces.append((piece.pose, slip, piece.margin, piece.contact))
        slipped = slip[-1]
    pose, slip, margin, contact = map(np.concatenate, zip(*pieces, strict=True))
    pose = np.concatenate([pose[:, :2], wrap(pose[:, 2:])], axis=1)
    return Prediction(pose, slip, margin, contact)


def time_of(walk: Walk) -> Array:
    """Of the moments recorded, from the start of the walk on, (T,) [s]."""
    return (walk.recording.during - walk.starts) * walk.setup.limits.timestep


def clearances(walk: Walk, predicted: Mapping[str, Prediction]) -> dict[str, Array]:
    """Clearance, achieved and predicted, (T,) each [m]; empty without obstacles."""
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
    angles = (s.schedule.angles(_recorded(walk, s)) for s in walk.stretches)
    swing, lift = map(np.concatenate, zip(*angles, strict=True))
    return swing, lift
