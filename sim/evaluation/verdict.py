"""The verdict on a walk, as one word and one sentence.

The verdict is the first of the following that applies: the robot fell, it collided, a
foot slipped, the walk drifted from its prediction, or it arrived.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from planner import Array
from sim.evaluation.motions import Achieved
from sim.evaluation.phases import phase_slip
from sim.motion.poses import tilt
from sim.motion.prediction import Prediction
from sim.walking.finished import Walk

FAILURES = ("fell", "collided")
TILTED = np.deg2rad(30)  # of a body that has fallen
LOW = 0.5  # of its height at the start, below which it has
TOLERATED = 0.05  # of the path: slip and drift beyond the quasi-static prediction


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a walk."""

    word: Literal["fell", "collided", "slipped", "drifted", "arrived"]
    text: str  # one sentence, without a full stop


def judge(
    walk: Walk, achieved: Achieved, predicted: Prediction | None, judged: Array
) -> Verdict:
    """The verdict on a walk, from its motion and its quasi-static prediction, if any.

    Extremes are taken over the moments that are judged, shape (T,), bool.
    """
    failure = _fell(walk, achieved, judged) or _collided(walk)
    if failure is not None:
        return failure
    goal = np.array(walk.setup.scenario.path.goal, dtype=float)
    end = f"{_distance(achieved.pose[-1], goal)} from the goal"
    if predicted is None:
        return Verdict("arrived", f"arrived {end}")
    by = _distance(achieved.pose[-1], predicted.pose[-1])
    end += f" and {by} from where the quasi-static prediction has it"
    return (
        _slipped(walk, predicted, end)
        or _drifted(walk, achieved.pose[judged] - predicted.pose[judged], end)
        or Verdict("arrived", f"arrived {end}")
    )


def _fell(walk: Walk, achieved: Achieved, judged: Array) -> Verdict | None:
    moments, kinematics = walk.recording.moments, walk.setup.kinematics
    standing = kinematics.standing
    height = float(kinematics.center_of_mass[2] - standing.height.min())
    weight = achieved.center_of_mass[:, 2]
    lost = weight[moments.step >= walk.starts][0] - weight
    leaning = tilt(moments.qpos, walk.setup.robot.root_address)
    down = judged & ((leaning > TILTED) | (lost > LOW * height))
    if not down.any():
        return None
    first = int(down.argmax())
    time = moments.step[first] * walk.setup.limits.timestep
    how = f"the body tilted by {np.rad2deg(leaning[first]):.0f} degrees"
    if leaning[first] <= TILTED:
        how = f"the body sank by {1e3 * lost[first]:.0f} of {1e3 * height:.0f} mm"
    return Verdict("fell", f"fell at {time:.1f} s: {how}")


def _collided(walk: Walk) -> Verdict | None:
    counts = {
        "parts of the robot touched each other": walk.recording.self_contacts,
        "the robot touched obstacles": walk.recording.wall_contacts,
    }
    touched = [
        f"{what} {count} {'time' if count == 1 else 'times'}"
        for what, count in counts.items()
        if count
    ]
    if not touched:
        return None
    return Verdict("collided", f"collided: {' and '.join(touched)}")


def _slipped(walk: Walk, predicted: Prediction, end: str) -> Verdict | None:
    """Whether a foot slipped while it was planned to stand and legs swung.

    What feet slip while others lift and land is no part of any prediction, and does not
    move the body.
    """
    robot = walk.setup.robot
    slip = np.zeros(len(robot.legs))
    for phase in walk.phases:
        if phase.kind == "swing":
            slip += phase_slip(walk, phase) * robot.planted(phase.stratum)
    excess = slip - predicted.slip[-1]
    worst = int(excess.argmax())
    if not excess[worst] > TOLERATED * _length(walk):
        return None
    return Verdict(
        "slipped",
        f"slipped: the foot of leg {robot.legs[worst]} moved "
        f"{1e3 * excess[worst]:.1f} mm more than predicted"
        f"{_share(excess[worst], walk)}; it ended {end}",
    )


def _drifted(walk: Walk, apart: Array, end: str) -> Verdict | None:
    off = float(np.hypot(*apart[:, :2].T).max())
    if not off > TOLERATED * _length(walk):
        return None
    return Verdict(
        "drifted",
        f"drifted: it was up to {1e3 * off:.1f} mm off the quasi-static prediction"
        f"{_share(off, walk)}, and ended {end}",
    )


def _distance(pose: Array, other: Array) -> str:
    return f"{1e3 * float(np.hypot(*(pose - other)[:2])):.2f} mm"


def _length(walk: Walk) -> float:
    """Length that shares are taken of, the way walked where the path has none [m]."""
    return walk.setup.scenario.path.length or walk.distance


def _share(part: float, walk: Walk) -> str:
    if not (length := _length(walk)):
        return ""
    what = "the path" if walk.setup.scenario.path.length else "the way walked"
    return f", {100 * part / length:.1f} % of {what}"
