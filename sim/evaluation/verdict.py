"""The verdict on a walk, as one word and one sentence.

The verdict is the first of the following that applies: the robot fell, it collided, a
foot slipped, the walk drifted from its prediction, or it arrived.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sim.evaluation.phases import phase_slip
from sim.motion.poses import tilt
from sim.walking.finished import Walk

if TYPE_CHECKING:
    from sim.evaluation.assessment import Evaluation

Word = Literal["fell", "collided", "slipped", "drifted", "arrived"]

FAILURES = ("fell", "collided")
TILTED = np.deg2rad(30)  # of a body that has fallen
LOW = 0.5  # of its height at the start, below which it has
TOLERATED = 0.05  # of the path: slip and drift beyond the quasi-static prediction


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a walk."""

    word: Word
    text: str  # one sentence, without a full stop


def judge(evaluation: Evaluation) -> Verdict:
    """The verdict on a walk.

    Args:
        evaluation: The walk beside its predictions.
    """
    found = (
        _fell(evaluation)
        or _collided(evaluation)
        or _slipped(evaluation)
        or _drifted(evaluation)
    )
    return found or Verdict("arrived", f"arrived {_whereabouts(evaluation)}")


def _fell(evaluation: Evaluation) -> Verdict | None:
    walk, judged = evaluation.walk, evaluation.judged
    moments, kinematics = walk.recording.moments, walk.setup.kinematics
    standing = kinematics.standing
    height = float(kinematics.center_of_mass[2] - standing.height.min())
    weight = evaluation.achieved.center_of_mass[:, 2]
    lost = weight[evaluation.walking][0] - weight
    leaning = tilt(moments.qpos, walk.setup.robot.root_address)
    down = judged & ((leaning > TILTED) | (lost > LOW * height))
    if not down.any():
        return None
    first = int(np.flatnonzero(down)[0])
    time = moments.step[first] * walk.setup.limits.timestep
    how = f"the body tilted by {np.rad2deg(leaning[first]):.0f} degrees"
    if leaning[first] <= TILTED:
        how = f"the body sank by {1e3 * lost[first]:.0f} of {1e3 * height:.0f} mm"
    return Verdict("fell", f"fell at {time:.1f} s: {how}")


def _collided(evaluation: Evaluation) -> Verdict | None:
    recording = evaluation.walk.recording
    touched = [
        f"{what} {count} {'time' if count == 1 else 'times'}"
        for what, count in (
            ("parts of the robot touched each other", recording.self_contacts),
            ("the robot touched obstacles", recording.wall_contacts),
        )
        if count
    ]
    if not touched:
        return None
    return Verdict("collided", f"collided: {' and '.join(touched)}")


def _slipped(evaluation: Evaluation) -> Verdict | None:
    prediction = evaluation.predicted.get("quasi_static")
    if prediction is None:
        return None
    length, name = _measure(evaluation)
    excess = _standing_slip(evaluation.walk) - prediction.slip[-1]
    worst = int(excess.argmax())
    if not excess[worst] > TOLERATED * length:
        return None
    leg = evaluation.walk.setup.robot.legs[worst]
    return Verdict(
        "slipped",
        f"slipped: the foot of leg {leg} moved {1e3 * excess[worst]:.1f} mm more than "
        f"predicted{_share(excess[worst], length, name)}; it ended "
        f"{_whereabouts(evaluation)}",
    )


def _standing_slip(walk: Walk) -> np.ndarray:
    """Slip of every foot while it is planned to stand and legs swing, (F,) [m].

    What feet slip while others lift and land is no part of any prediction, and does not
    move the body.
    """
    slip = np.zeros(len(walk.setup.robot.legs))
    for phase in walk.phases:
        if phase.kind == "swing":
            slip += phase_slip(walk, phase) * walk.setup.robot.planted(phase.stratum)
    return slip


def _drifted(evaluation: Evaluation) -> Verdict | None:
    prediction = evaluation.predicted.get("quasi_static")
    if prediction is None:
        return None
    length, name = _measure(evaluation)
    judged = evaluation.judged
    apart = evaluation.achieved.pose[judged] - prediction.pose[judged]
    off = float(np.hypot(*apart[:, :2].T).max())
    if not off > TOLERATED * length:
        return None
    return Verdict(
        "drifted",
        f"drifted: it was up to {1e3 * off:.1f} mm off the quasi-static prediction"
        f"{_share(off, length, name)}, and ended {_whereabouts(evaluation)}",
    )


def _whereabouts(evaluation: Evaluation) -> str:
    """How far the end is from the goal and from where it was predicted."""
    end = evaluation.achieved.pose[-1]
    goal = np.array(evaluation.walk.setup.scenario.path.goal, dtype=float)
    text = f"{_distance(end, goal)} from the goal"
    prediction = evaluation.predicted.get("quasi_static")
    if prediction is None:
        return text
    by = _distance(end, prediction.pose[-1])
    return f"{text} and {by} from where the quasi-static prediction has it"


def _distance(pose: np.ndarray, other: np.ndarray) -> str:
    return f"{1e3 * float(np.hypot(*(pose - other)[:2])):.2f} mm"


def _measure(evaluation: Evaluation) -> tuple[float, str]:
    """Length that shares are taken of, the way walked where the path has none [m]."""
    if length := evaluation.walk.setup.scenario.path.length:
        return length, "the path"
    stride = evaluation.walk.setup.equations.stride
    swings = (p for p in evaluation.walk.phases if p.kind == "swing")
    return float(sum(stride(p.field) * abs(p.amount) for p in swings)), "the way walked"


def _share(part: float, length: float, name: str) -> str:
    return f", {100 * part / length:.1f} % of {name}" if length else ""
