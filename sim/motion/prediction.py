"""Predictions for a schedule: pose, slip and stability margin at any step.

All are the same computation with different twist models; the body stays level, and
still during lift-offs and touchdowns. Least margins and clearances of a walk are taken
over `inspections`, between which legs swing by at most 0.02 rad: a smooth minimum is
missed by the length of a leg times half of 0.01 squared, five micrometres, at most.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from models import Kinematics, TwistModel
from models.motion import Strokes
from planner import Array
from sim.motion.poses import compose
from sim.motion.schedule import Schedule
from sim.motion.stability import stability_margin

INSPECTED_SWING = 0.02  # [rad] that the legs swing at most between inspections
LIFTS = 4  # inspections of a lift-off or touchdown


@dataclass(frozen=True)
class Prediction:
    """Predicted motion at chosen steps of a schedule."""

    pose: Array  # x, y [m], yaw [rad] not wrapped, shape (T, 3)
    slip: Array  # of each foot since the schedule's start, shape (T, F) [m]
    margin: Array  # signed, shape (T,) [m]
    contact: Array  # planned, shape (T, F), bool

    @property
    def further(self) -> dict[str, Array]:
        """What else it predicts, by the names of quantities."""
        return {}


@dataclass(frozen=True)
class Commanded:
    """What is commanded at chosen steps, whatever the body makes of it."""

    phase: Array  # index of the phase that each step lies in, shape (T,)
    swing: Array  # angle of every group, shape (T, G) [rad]
    contact: Array  # planned, shape (T, F), bool
    margin: Array  # of the level body over the planned contacts, shape (T,) [m]


def commanded(schedule: Schedule, rows: Array, kinematics: Kinematics) -> Commanded:
    """Angles, contacts and stability margin at steps (T,) of a schedule, from 0."""
    swing, lift = schedule.angles(rows)
    phase = schedule.phase_of(rows)
    planted = [phase.planted(kinematics.robot) for phase in schedule.phases]
    contact = np.array(planted)[phase]
    stance = kinematics.stance(swing, lift)
    margin = stability_margin(stance.feet, contact, stance.center_of_mass)
    return Commanded(phase, swing, contact, margin)


class Predictor:
    """Predicts the motion of one schedule at any steps, from `start_pose`, (3,)."""

    def __init__(
        self,
        schedule: Schedule,
        twists: TwistModel,
        kinematics: Kinematics,
        start_pose: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        self.schedule, self.kinematics = schedule, kinematics
        self.start_pose = np.asarray(start_pose, dtype=float)
        strata = [phase.stratum for phase in schedule.phases]
        moves = list(zip(strata, schedule.trajectories[0][1], strict=True))
        start = schedule.begin.swing
        strokes, self._loaded = Strokes.among(moves, schedule.limits.groups, start)
        self._path = strokes.travel(twists, kinematics)

    def configurations(self, rows: Array) -> tuple[Array, Array, Array]:
        """Pose (T, 3), and commanded swing and lift of every group (T, G) [rad]."""
        swing, lift = self.schedule.angles(rows)
        clock = self._clock(self.schedule.phase_of(rows), swing)
        return compose(self.start_pose, self._path.pose(clock)), swing, lift

    def __call__(self, rows: Array) -> Prediction:
        """Predict the motion at steps, shape (T,); step 0 is the schedule's first."""
        return self.along(commanded(self.schedule, rows, self.kinematics))

    def along(self, given: Commanded) -> Prediction:
        """Predict the motion at steps whose commands are known already."""
        clock = self._clock(given.phase, given.swing)
        pose = compose(self.start_pose, self._path.pose(clock))
        return Prediction(pose, self._path.slip(clock), given.margin, given.contact)

    def _clock(self, phase: Array, swing: Array) -> Array:
        """Each row's moment on the clock of the strokes, shape (T,)."""
        (begin, change), loaded = self.schedule.trajectories[0], self._loaded
        before = np.cumsum(loaded) - loaded  # strokes finished before each phase
        length = np.where(loaded, (change**2).sum(axis=1), 1.0)
        gone = ((swing - begin[phase]) * change[phase]).sum(axis=1) / length[phase]
        return before[phase] + np.where(loaded[phase], gone, 0.0)


def inspections(schedule: Schedule) -> Array:
    """Steps, counted from the start of the run, to inspect the state after, (L,)."""
    found = [np.zeros(0, dtype=int)]
    for phase in schedule.phases:
        samples = LIFTS
        if phase.kind == "swing":
            farthest = abs(phase.amount) * max(map(abs, phase.direction))
            samples = 1 + int(np.ceil(farthest / INSPECTED_SWING))
        found.append(1 + phase.start + _spread(phase.steps, samples))
    return np.concatenate(found)


@lru_cache(maxsize=1024)  # phases are many, and their lengths few
def _spread(steps: int, samples: int) -> Array:
    """At most so many steps, even distances apart and the last one among them."""
    ends = np.linspace(0, steps - 1, min(samples, steps) + 1)[1:]
    return np.unique(ends.round().astype(int))
