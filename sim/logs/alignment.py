"""What was measured on a real robot, brought onto the frame and the clock of a walk.

Poses are seen from the first one. A camera that is turned against the robot is turned
back: the direction in which the body moves, as the body sees it, is that of the
prediction on average, however much the robot veers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import degrees, hypot, radians

import numpy as np

from planner import Array
from sim.logs.log import Log
from sim.motion.poses import relative, rotate, seen_from, wrap

TURNED_FRAME = radians(5)  # from which on a frame is taken to be turned
WAY_PIECES = 20  # of the way, over which directions are compared
MOVED_ENOUGH = 0.01  # [m] in all, without which nothing is known of directions
SAME_COMMAND = radians(1)  # by which commands of trials may differ


@dataclass(frozen=True)
class Measured:
    """A real robot in the start frame, and what was done to get it; None is unknown."""

    pose: Array | None = None  # (T, 3), finite
    spread: Array | None = None  # standard error of the mean of trials, (T, 3)
    lean: Mapping[str, Array] = field(default_factory=dict)  # since the first row, (T,)
    done: tuple[str, ...] = ()

    @property
    def arrays(self) -> dict[str, Array]:
        """What is known, by name."""
        return {**({} if self.pose is None else {"pose": self.pose}), **self.lean}


def together(logs: Sequence[Log]) -> Log:
    """Trials of one motion as one log: commands of the first, means of poses.

    Raises:
        ValueError: They command other joints.
    """
    first, *others = logs
    if not others:
        return first
    done, poses, leans = list(first.done), [], []
    for number, log in enumerate(logs, 1):
        if {*log.joints} != {*first.joints}:
            raise ValueError(f"trial {number} commands other joints than the first")
        order = [log.joints.index(joint) for joint in first.joints]
        off = float(np.abs(log.at(first.time)[:, order] - first.commanded).max())
        if off > SAME_COMMAND:
            other = f"commands of trial {number} differ by up to {degrees(off):.2g}"
            done.append(f"{other} degrees; those of the first are played")
        if log.pose is not None:
            poses.append(_finite(first.time, log.time, log.pose))
        if log.lean is not None:
            leans.append(_since_first(first.time, log.time, log.lean))
    first = replace(first, lean=np.mean(leans, axis=0) if leans else None)
    if len(poses) < 2:
        return replace(first, done=(*done, "fewer than two trials have a pose"))
    stack = np.stack([seen_from(pose[0], pose) for pose in poses])
    stack[..., 2] = np.unwrap(stack[..., 2], axis=1)
    spread = stack.std(axis=0, ddof=1) / np.sqrt(len(stack))
    done.append(f"mean of {len(stack)} trials, with its standard error")
    return replace(first, pose=stack.mean(axis=0), spread=spread, done=tuple(done))


def measured(log: Log, time: Array, predicted: Array) -> Measured | None:
    """What the log measured at times (T,) [s], beside a prediction (T, 3).

    None where it measured nothing.
    """
    lean = {}
    if log.lean is not None:
        leans = _since_first(time, log.time, log.lean).T
        both = zip(("roll", "pitch"), leans, strict=True)
        lean = {name: angle for name, angle in both if np.isfinite(angle).all()}
    if log.pose is None or not np.isfinite(log.pose[:, 0]).any():
        other = lean or log.measured is not None or log.contact
        return Measured(lean=lean) if other else None
    done: list[str] = []
    if missing := np.count_nonzero(~np.isfinite(log.pose[:, 0])):
        done.append(f"poses are interpolated in rows that have none, {missing} in all")
        last = log.time[np.isfinite(log.pose[:, 0])][-1]
        held = f"no pose was measured after {last:.4g} s, and that one is held"
        done += [held] * bool(last < log.time[-1])
    pose = _finite(time, log.time, log.pose)
    if not np.isfinite(pose[:, 2]).all():
        pose[:, 2] = predicted[:, 2]
        done.append("no yaw was measured; that of the prediction is taken")
    x, y, yaw = pose[0].tolist()
    if hypot(x, y) > MOVED_ENOUGH or abs(wrap(yaw)) > TURNED_FRAME:
        first = f"({x:.3g}, {y:.3g}) m and {degrees(yaw):.1f} degrees"
        done.append(f"poses are counted from the first one, at {first} in their frame")
    seen = seen_from(pose[0], pose)
    turned = _turned(seen, predicted)
    if abs(turned) > TURNED_FRAME:
        seen[:, :2] = rotate(seen[:, :2], -turned)
        against = f"{degrees(turned):.1f} degrees against the robot"
        done.append(f"its frame is turned by {against}, and was turned back")
    spread = None if log.spread is None else _finite(time, log.time, log.spread)
    return Measured(seen, spread, lean, tuple(done))


def _turned(pose: Array, predicted: Array) -> float:
    """Angle from the prediction's directions of motion to the measured ones [rad]."""
    rows = np.linspace(0, len(pose) - 1, WAY_PIECES + 1).round().astype(int)
    ways = [relative(p[rows[:-1]], p[rows[1:]])[:, :2] for p in (predicted, pose)]
    one, other = (way[:, 0] + 1j * way[:, 1] for way in ways)
    if min(np.abs(one).sum(), np.abs(other).sum()) < MOVED_ENOUGH:
        return 0.0
    return float(wrap(np.angle((np.conj(one) * other).sum())))


def _since_first(time: Array, when: Array, lean: Array) -> Array:
    """Roll and pitch at other times, from the first row on; a sensor sits askew."""
    found = _finite(time, when, lean)
    return found - found[0]


def _finite(time: Array, when: Array, rows: Array) -> Array:
    """Rows at other times, evenly across gaps; columns without numbers stay so."""
    found = np.full((len(time), rows.shape[1]), np.nan)
    for number, column in enumerate(rows.T):
        if (there := np.isfinite(column)).any():
            known = np.unwrap(column[there]) if number == 2 else column[there]
            found[:, number] = np.interp(time, when[there], known)
    return found
