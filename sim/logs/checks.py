"""Checks of what a log holds, and what is said of it; each refusal is a ValueError."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from planner import Array

LONGEST_LOG = 600.0  # [s]
FARTHEST = 4 * np.pi  # [rad]
JITTER = 0.05  # of a step of the clock, that is mentioned
CLOCK_GAP = 2.5  # steps of the clock; what is longer is a gap


def check_time(time: Array) -> None:
    """Refuse times [s] that are missing, do not ascend, or last too long."""
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0]) + 1
        raise ValueError(f"no time in row {row}; give each row its time [s]")
    if (back := np.diff(time) <= 0).any():
        row = int(back.argmax())
        raise ValueError(
            f"time goes from {time[row]:.9g} s to {time[row + 1]:.9g} s in row "
            f"{row + 2}; sort the rows, and keep one a moment"
        )
    if (length := time[-1] - time[0]) > LONGEST_LOG:
        raise ValueError(
            f"it lasts {length:.6g} s; give at most {LONGEST_LOG:g} s, in seconds"
        )


def clock(time: Array) -> Iterator[str]:
    """What is said of the times of rows."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    if time[0] != 0:
        yield f"time begins at {time[0]:.6g} s and is counted from there"
    if (gaps := steps > CLOCK_GAP * usual).any():
        yield (
            f"gaps of up to {steps.max():.3g} s between rows, {gaps.sum()} in all; "
            "commands go evenly across"
        )
    regular = steps[~gaps]
    if len(regular) and regular.std() > JITTER * usual:
        yield (
            f"the clock jitters by {1e3 * regular.std():.2g} ms around "
            f"{1e3 * usual:.3g} ms; each row keeps its own time"
        )


def bridged(time: Array, angle: Array, joint: str, said: list[str]) -> Array:
    """Commands with even passages where cells are empty."""
    there = np.isfinite(angle)
    if there.all():
        return angle
    if not there.any():
        raise ValueError(f"column {joint!r} is empty; leave it out")
    rows = np.flatnonzero(there)
    longest = np.diff(time[rows])[np.diff(rows) > 1].max(initial=0.0)
    said.append(
        f"{joint}: {np.count_nonzero(~there)} empty cells bridged, {longest:.3g} s "
        "at most"
    )
    return np.interp(time, time[there], angle[there])


def check_angles(time: Array, joints: Sequence[str], angles: Array) -> None:
    """Refuse angles that no joint takes: those of other units, or wild ones."""
    row, column = map(int, np.unravel_index(np.abs(angles).argmax(), angles.shape))
    if abs(angle := angles[row, column]) > FARTHEST:
        raise ValueError(
            f"{joints[column]!r} comes to {angle:.4g} rad in row {row + 1}, at "
            f"{time[row]:.4g} s; give --units where these are no radians, or correct it"
        )
