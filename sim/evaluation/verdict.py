"""The verdict on a walk: the first word that applies, where it ended, and the cause."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from planner import Array
from sim.evaluation.causes import Evidence, likely_cause
from sim.evaluation.deviations import Scale, departure
from sim.evaluation.phases import standing_slip
from sim.evaluation.summary import NEAR, Departure, Weighed
from sim.motion.poses import tilt, wrap
from sim.motion.prediction import Prediction
from sim.scenarios.predictions import PREDICTIONS
from sim.walking.finished import Walk

FAILURES = ("fell", "collided")
TILTED = np.deg2rad(30)  # of a body that has fallen
LOW = 0.5  # of its height at the start, below which it has
TOLERATED = 0.05  # of the path: distance from the goal, and from the prediction
ASTRAY = 0.25  # of the path: off the prediction on a way that went well
SLIPPED = 0.1  # of the predicted slip: more of it; good walks slip 1 to 24 % less

Word = Literal["fell", "collided", "missed", "drifted", "slipped", "arrived"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a walk."""

    word: Word
    text: str  # one sentence, without a full stop


def judge(evidence: Evidence, judged: Array) -> Verdict:
    """The verdict on a walk, from its motion, its predictions and what was weighed.

    Extremes are taken over the moments that are judged, shape (T,), bool.
    """
    walk, asked = evidence.walk, evidence
    evidence = _by_the_nearest(asked, judged)
    weighed, best = evidence.weighed, evidence.best
    end, goal = evidence.achieved.pose[-1], walk.setup.scenario.goal
    label = PREDICTIONS[weighed.prediction].label
    ended = f"{departure(end, best.pose[-1])} from the end of the {label} prediction"
    if goal is not None:
        ended = f"{departure(end, np.array(goal))} from the goal and {ended}"
    if evidence is not asked:
        ended += f"; the miss is a prediction's: it was {_astray(asked, judged)}"
    word, how = (
        _fell(evidence, judged)
        or _collided(walk)
        or _missed(evidence)
        or _drifted(evidence, judged)
        or _slipped(walk, best, weighed)
        or ("arrived", "")
    )
    if cause := likely_cause(word, evidence):
        ended += f"; {cause}"
    return Verdict(word, f"{how}; it ended {ended}" if how else f"arrived {ended}")


def _by_the_nearest(evidence: Evidence, judged: Array) -> Evidence:
    """The same by the nearest prediction, if only others miss a walk to its goal."""
    weighed, goal = evidence.weighed, evidence.walk.setup.scenario.goal
    reached = weighed.goal is not None and weighed.goal <= TOLERATED
    if not reached or weighed.ended_well or not TOLERATED < weighed.farthest <= ASTRAY:
        return evidence
    poses, size = evidence.achieved.pose[judged], (weighed.radius, weighed.length)
    each = (
        Scale(name, *size).weigh(poses, made.pose[judged], goal)
        for name, made in evidence.predicted.items()
    )
    nearest = min(each, key=lambda one: one.farthest)
    kept = nearest.farthest <= TOLERATED
    return replace(evidence, weighed=nearest) if kept else evidence


Found = tuple[Word, str] | None


def _fell(evidence: Evidence, judged: Array) -> Found:
    walk, weight = evidence.walk, evidence.achieved.center_of_mass[:, 2]
    moments, kinematics = walk.recording.moments, walk.setup.kinematics
    height = float(kinematics.center_of_mass[2] - kinematics.standing.height.min())
    lost = weight[evidence.walking][0] - weight
    leaning = tilt(moments.qpos, walk.setup.robot.root_address_in(walk.setup.model))
    down = judged & ((leaning > TILTED) | (lost > LOW * height))
    if not down.any():
        return None
    first = int(down.argmax())
    time = moments.step[first] * walk.setup.limits.timestep
    how = f"the body tilted by {np.rad2deg(leaning[first]):.0f} degrees"
    if leaning[first] <= TILTED:
        how = f"the body sank by {1e3 * lost[first]:.0f} of {1e3 * height:.0f} mm"
    return "fell", f"fell at {time:.1f} s: {how}"


def _collided(walk: Walk) -> Found:
    counts = (
        ("parts of the robot touched each other", walk.recording.self_contacts),
        ("the robot touched obstacles", walk.recording.wall_contacts),
    )
    touched = [f"{what} {n} time{'' if n == 1 else 's'}" for what, n in counts if n]
    return ("collided", f"collided: {' and '.join(touched)}") if touched else None


def _missed(evidence: Evidence) -> Found:
    weighed, goal = evidence.weighed, evidence.walk.setup.scenario.goal
    if goal is None or weighed.goal is None or weighed.goal <= TOLERATED:
        return None
    off = departure(evidence.achieved.pose[-1], np.array(goal))
    return "missed", f"missed its goal by {_share(weighed, weighed.goal, off)}"


def _share(weighed: Weighed, share: float, off: Departure) -> str:
    """A share of the path, and what yaw has to do with it, where it counts."""
    words = f"{100 * share:.1f} % of the path"
    if weighed.ended_well:
        return words
    if weighed.radius * off.yaw <= off.position:
        return f"{words}, yaw included"
    return f"{words}, most of it by a yaw of {np.rad2deg(off.yaw):.2g} degrees"


def _drifted(evidence: Evidence, judged: Array) -> Found:
    """Whether it was off its prediction; where it ended well, the way counts less."""
    weighed = evidence.weighed
    if weighed.farthest <= (ASTRAY if weighed.ended_well else TOLERATED):
        return None
    return "drifted", f"drifted: it was {_astray(evidence, judged)}"


def _astray(evidence: Evidence, judged: Array) -> str:
    """How far the walk was off its prediction at most, and what share that is."""
    weighed = evidence.weighed
    apart = evidence.achieved.pose[judged] - evidence.best.pose[judged]
    far, turned = np.hypot(*apart[:, :2].T).max(), np.abs(wrap(apart[:, 2])).max()
    off = Departure(position=float(far), yaw=float(turned))
    name, share = PREDICTIONS[weighed.prediction].label, weighed.farthest
    return f"up to {off} off the {name} prediction, {_share(weighed, share, off)}"


def _slipped(walk: Walk, predicted: Prediction, weighed: Weighed) -> Found:
    """Whether feet slid so much farther than predicted that the body did with them."""
    slip, foreseen = standing_slip(walk), standing_slip(walk, predicted.slip)
    more, expected = float((slip - foreseen).sum()), float(foreseen.sum())
    least = max(SLIPPED * expected, NEAR * weighed.length)
    if weighed.ended <= NEAR or more <= least:
        return None
    leg = walk.setup.robot.legs[int((slip - foreseen).argmax())]
    slid = f"its feet slid {1e3 * (expected + more):.1f} mm"
    asked = f"where {1e3 * expected:.1f} mm were predicted"
    return "slipped", f"slipped: {slid} {asked}, the foot of leg {leg} most of all"
