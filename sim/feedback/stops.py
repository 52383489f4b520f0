"""What a walk with feedback meant, saw, thought and did, segment by segment."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from planner import Array
from sim.feedback.filter import Feedback, Learnt, bound
from sim.folder import csv_rows, csv_text
from sim.motion.poses import POSE, seen_from

Numbers = tuple[float, ...]
LARGEST = 1e9  # number of a stop
UNKNOWN = np.diag([0.02, 0.02, 0.05]) ** 2  # of a b of which hardly anything is known
FLAT = 1e-6  # singular values below it, as a share of the largest, are none
NAMES = {  # of the columns of feedback.csv, by the fields of a stop in their order
    "meant": POSE,
    "seen": (*POSE, "gyro"),
    **dict.fromkeys(("expected", "doubt", "thought", "claimed", "true", "bias"), POSE),
}
COLUMNS = (
    *("segment", "time", "seconds"),
    *(f"{key}_{name}" for key, names in NAMES.items() for name in names),
)


class Stop(NamedTuple):
    """The end of a segment; poses in the start frame, lengths in m, angles in rad."""

    segment: int  # its number, from 0
    time: float  # of the stop [s]
    seconds: float  # that the segment took [s]
    meant: Numbers  # motion that was planned, in the frame where the segment began
    seen: Numbers  # the camera's pose and the gyroscope's yaw; NaN if not told
    expected: Numbers  # pose that was thought before that
    doubt: Numbers  # standard deviation that is claimed for that
    thought: Numbers  # pose that is thought after it
    claimed: Numbers  # standard deviation that is then claimed
    true: Numbers  # pose in the physics
    bias: Numbers  # b, what is thought that every segment misses


def written(stops: Iterable[Stop]) -> str:
    """The text of feedback.csv: one line a stop, empty where nothing was told."""
    rows: list[tuple[object, ...]] = [COLUMNS]
    for stop in stops:
        flat = np.hstack([np.ravel(value) for value in stop[1:]]).tolist()
        rows.append((stop.segment, *("" if np.isnan(v) else v for v in flat)))
    return csv_text(rows)


def read(text: str) -> tuple[Stop, ...]:
    """The stops that a text of `written` lists; KeyError, ValueError if damaged."""
    stops: list[Stop] = []
    for number, table in enumerate(csv_rows(text, "feedback.csv")):
        with suppress(ValueError):
            groups = (
                tuple(float(table[f"{key}_{name}"] or "nan") for name in names)
                for key, names in NAMES.items()
            )
            first = int(table["segment"]), float(table["time"]), float(table["seconds"])
            stop = Stop(*first, *groups)
            if stop.segment == number and _may_follow(stop, stops):
                stops.append(stop)
                continue
        raise ValueError(f"feedback.csv has an impossible stop {number}")
    return tuple(stops)


def _may_follow(stop: Stop, others: Sequence[Stop]) -> bool:
    """Whether a walk may have a stop after those before it."""
    numbers = np.hstack(stop._replace(seen=tuple(np.nan_to_num(stop.seen))))
    later = stop.time > (others[-1].time if others else 0.0)
    spreads = (stop.seconds, *stop.doubt, *stop.claimed)
    return later and min(spreads) >= 0 and bool((np.abs(numbers) < LARGEST).all())


def stop_after(
    feedback: Feedback,
    segment: int,
    time: float,
    seconds: float,
    meant: Array,
    seen: Array,
    true: Array,
) -> Stop:
    """Tell feedback of a segment that was walked, and take down what it makes of it."""
    feedback.moved(meant, seconds)
    before = feedback.pose, feedback.claimed
    feedback.seen(seen[:3], seen[3])
    rows = meant, seen, *before, feedback.pose, feedback.claimed, true, feedback.bias
    return Stop(segment, time, seconds, *(tuple(row.tolist()) for row in rows))


@dataclass(frozen=True, eq=False)
class Followed:
    """A walk that was planned piece by piece: its stops, and feedback at the end."""

    stops: tuple[Stop, ...]
    feedback: Feedback
    learns: bool

    @property
    def learnt(self) -> Learnt | None:
        """For the next walk of the same robot; None if nothing was to be learnt."""
        return self.feedback.learnt if self.learns else None

    @property
    def claimed(self) -> tuple[float, float]:
        """Claimed error before the last reading, as `bound` gives it [m], [rad]."""
        spread = np.array(self.stops[-1].doubt)
        return float(np.hypot(*spread[:2])), float(spread[2])

    @cached_property
    def bound(self) -> tuple[float, float]:
        """Least error of position [m] and yaw [rad] that any estimator could have had.

        That estimator knows A, and as much of b beforehand as the filter, if this one
        learns. Scatter is what segments missed beside the best affine function of what
        was meant.
        """
        meant = np.array([stop.meant for stop in self.stops])
        poses = np.array([np.zeros(3), *(stop.true for stop in self.stops)])
        missed = seen_from(poses[:-1], poses[1:]) - meant
        known = np.column_stack([np.ones(len(meant)), meant])
        fitted, _, rank, _ = np.linalg.lstsq(known, missed, rcond=FLAT)
        left = len(meant) - int(rank)
        scatter = self.feedback.scatter
        if left > 0:
            scatter = np.sqrt(((missed - known @ fitted) ** 2).sum(axis=0) / left)
        seen = np.array([stop.seen for stop in self.stops])
        seconds = np.array([stop.seconds for stop in self.stops])
        told = self.feedback.sensing, meant, seen, scatter, seconds
        return bound(*told, self.feedback.foreknown if self.learns else UNKNOWN)
