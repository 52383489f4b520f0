"""What was measured on a real robot, brought onto the frame and the clock of a walk.

Poses are seen from the first one. A camera that is turned against the robot is turned
back: the direction in which the body moves, as the body sees it, is that of the
prediction on average, however much the robot veers.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import degrees, hypot, radians

import numpy as np

from planner import Array
from sim.errors import message
from sim.logs.log import BODY, Log
from sim.motion.poses import relative, rotate, seen_from, wrap

TURNED_FRAME = radians(5)  # from which on a frame is taken to be turned
MOVED_ENOUGH = 0.01  # [m] in all, without which nothing is known of directions
COLUMNS = (*BODY["pose"], *BODY["lean"])


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
    """Trials of one motion as one log: commands of the first, the mean of the bodies'.

    Each column of it ends where the first trial lost it.

    Raises:
        ValueError: They command other joints.
    """
    first, *others = logs
    if not others:
        return first
    done, kept, bodies = list(first.done), list[Array](), [_body(log) for log in logs]
    known = np.stack([np.isfinite(rows).any(axis=0) for rows in bodies])
    most = max(known, key=lambda own: (own[0], own.sum()))  # its place before all else
    for number, (log, own) in enumerate(zip(logs, known, strict=True), 1):
        if {*log.joints} != {*first.joints}:
            raise ValueError(f"trial {number} commands other joints than the first")
        both = first.time <= log.time[-1]  # it may have ended before
        apart = ordered(log, first.joints).at(first.time) - first.commanded
        if (off := float(np.abs(apart[both]).max(initial=0))) > radians(1):
            other = f"commands of trial {number} differ by up to {degrees(off):.2g}"
            done.append(f"{other} degrees; those of the first are played")
        done += (f"trial {number}, {gap}" for gap in _gaps(log))
        if names := ", ".join(np.array(COLUMNS)[most & ~own]):
            done.append(message("lacking", number=number, names=names))
        elif most.any():
            kept.append(_finite(first.time, log.time, bodies[number - 1], held=False))
    if any(log.measured is not None or log.contact for log in others):
        done.append(message("first_alone"))
    if not kept:
        return replace(first, done=tuple(done))
    start = np.nan_to_num(np.stack(kept)[:, :1])
    pose = seen_from(start[..., :3], np.stack(kept)[..., :3])
    pose[..., 2] = np.unwrap(pose[..., 2], axis=1)
    lean = (np.stack(kept) - start)[..., 3:].mean(axis=0)
    if (count := len(kept)) > 1:
        done.append(f"mean of {count} trials, with its standard error")
        first = replace(first, spread=pose.std(axis=0, ddof=1) / np.sqrt(count))
    return replace(first, pose=pose.mean(axis=0), lean=lean, done=tuple(done))


def ordered(log: Log, joints: Sequence[str]) -> Log:
    """The same log with its joints in another order."""
    at = [log.joints.index(joint) for joint in joints]
    angles = None if log.measured is None else log.measured[:, at]
    rows = log.commanded[:, at]
    return replace(log, joints=tuple(joints), commanded=rows, measured=angles)


def measured(log: Log, time: Array, predicted: Array) -> Measured | None:
    """What a log measured at (T,) [s], beside a prediction (T, 3); None if nothing."""
    body, done = _finite(time, log.time, _body(log)), [*_gaps(log)]
    both = zip(("roll", "pitch"), (body - body[0]).T[3:], strict=True)
    lean = {name: angle for name, angle in both if np.isfinite(angle).all()}
    if not np.isfinite(body[0, 0]):
        if np.isfinite(body[0, 2]):
            done.append(message("yaw_alone"))
        other = lean or done or log.measured is not None or log.contact
        return Measured(lean=lean, done=tuple(done)) if other else None
    pose = body[:, :3]
    if not np.isfinite(pose[0, 2]):
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
    if spread is not None and not np.isfinite(spread).all():
        spread = None
        done.append(message("some_errors"))
    return Measured(seen, spread, lean, tuple(done))


def _turned(pose: Array, predicted: Array) -> float:
    """Angle from the prediction's directions of motion to the measured ones [rad]."""
    rows = np.linspace(0, len(pose) - 1, 21).round().astype(int)  # 20 pieces
    ways = [relative(p[rows[:-1]], p[rows[1:]])[:, :2] for p in (predicted, pose)]
    one, other = (way[:, 0] + 1j * way[:, 1] for way in ways)
    if min(np.abs(one).sum(), np.abs(other).sum()) < MOVED_ENOUGH:
        return 0.0
    read = np.abs(other) <= 10 * np.abs(one).max() + MOVED_ENOUGH  # others are misread
    return float(wrap(np.angle((np.conj(one) * other)[read].sum())))


def _body(log: Log) -> Array:
    """What was measured of the body, a column each of `COLUMNS`, (n, 5)."""
    rows = len(log.time)
    pose = np.full((rows, 3), np.nan) if log.pose is None else log.pose
    lean = np.full((rows, 2), np.nan) if log.lean is None else log.lean
    return np.hstack([pose, lean])


def _gaps(log: Log) -> Iterator[str]:
    """What is done about gaps in what was measured of the body."""
    found = defaultdict[bytes, list[str]](list)
    for name, column in zip(COLUMNS, _body(log).T, strict=True):
        found[np.isfinite(column).tobytes()].append(name)
    for cells, names in found.items():
        there = np.frombuffer(cells, bool)
        if there.all() or not there.any():
            continue
        first, last = log.time[there][[0, -1]]
        held = [f"before {first:.4g} s"] * bool(first > log.time[0])
        held += [f"after {last:.4g} s"] * bool(last < log.time[-1])
        words = f"{', '.join(names)}: empty cells bridged, {(~there).sum()} in each"
        yield "; held ".join([words, *[" and ".join(held)] * bool(held)])


def _finite(time: Array, when: Array, rows: Array, held: bool = True) -> Array:
    """Rows at other times, evenly across gaps; columns without numbers stay so.

    The last number of a column is held, or there is none a step after it.
    """
    found = np.full((len(time), rows.shape[1]), np.nan)
    for number, column in enumerate(rows.T):
        if (there := np.isfinite(column)).any():
            known = np.unwrap(column[there]) if number >= 2 else column[there]
            found[:, number] = np.interp(time, when[there], known)
            end = np.inf if held else when[there][-1] + np.diff(time).max()
            found[time > end, number] = np.nan
    return found
