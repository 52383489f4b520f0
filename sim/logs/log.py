"""Logs: joint motion over time, and what was measured on a real robot meanwhile.

A file is a table of numbers with a line of names. `time` [s] and a column a joint, by
its name, hold the commands. What was measured may stand beside them: `measured.JOINT`,
`body.x`, `body.y` [m], `body.yaw`, `body.roll`, `body.pitch`, and `contact.LEG` (0 or
1). Empty cells are gaps. What is in a file is numbers alone; nothing is carried out.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, nan, radians
from pathlib import Path

import numpy as np

from planner import Array
from planner.support import did_you_mean, read_file
from sim.errors import UsageError

LARGEST = 10**8  # bytes
MOST_ROWS = 10**6
TIME, MEASURED, BODY, CONTACT = "time", "measured.", "body.", "contact."
POSE, LEAN = ("x", "y", "yaw"), ("roll", "pitch")
TURNED = ("yaw", *LEAN)  # columns of the body that are angles
LONGEST = 600.0  # [s]
FARTHEST = 4 * np.pi  # [rad]
JITTER = 0.05  # of a step of the clock, that is mentioned
GAP = 2.5  # steps of the clock; what is longer is a gap

Reader = Callable[[str, Array], Array]  # angles [rad] of a joint's numbers


@dataclass(frozen=True, eq=False)
class Log:
    """Commanded joint angles over time, and what was measured meanwhile.

    Rows are ascending in time and start at 0. Commands are finite; measured numbers are
    NaN where the log has a gap, and None where it has no such columns.

    Raises:
        ValueError: Arrays contradict one another, time does not ascend, or a command is
            not finite.
    """

    time: Array  # (n,) [s]
    joints: tuple[str, ...]  # names, in the order of columns
    commanded: Array  # (n, J) [rad]
    measured: Array | None = None  # angles of the same joints, (n, J) [rad]
    pose: Array | None = None  # of the body: x, y [m], yaw [rad], (n, 3)
    lean: Array | None = None  # roll, pitch [rad], (n, 2)
    contact: Mapping[int, Array] = field(default_factory=dict)  # 0 or 1 a leg, (n,)
    done: tuple[str, ...] = ()  # what was done to it, a line each

    def __post_init__(self) -> None:
        rows, width = len(self.time), len(self.joints)
        if rows < 2:
            raise ValueError(f"{rows} rows; give two at least")
        if self.commanded.shape != (rows, width):
            raise ValueError(f"commands {self.commanded.shape} for {(rows, width)}")
        if not np.isfinite(self.commanded).all():
            raise ValueError("a command is not a finite number")
        if (np.diff(self.time) <= 0).any():
            raise ValueError("time does not ascend")

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def step(self) -> float:
        """Usual time from one row to the next [s]."""
        return float(np.median(np.diff(self.time)))

    def at(self, time: Array) -> Array:
        """Commands at times (T,), evenly between rows, held beyond the ends, (T, J)."""
        columns = [np.interp(time, self.time, angle) for angle in self.commanded.T]
        return np.stack(columns, axis=1)

    def repeated(self, times: int) -> Log:
        """The same motion several times over; what was measured is left out.

        The last row begins the next period, so that it must be like the first one.
        """
        apart = float(np.abs(self.commanded[-1] - self.commanded[0]).max())
        if times > 1 and apart > radians(1):
            raise ValueError(
                f"its last row is {apart:.3g} rad from its first one and cannot be "
                "repeated; let it end where it begins"
            )
        starts = np.arange(times)[:, None] * self.time[-1]
        time = np.append((starts + self.time[:-1]).ravel(), times * self.time[-1])
        rows = np.tile(self.commanded[:-1], (times, 1))
        whole = np.vstack([rows, self.commanded[-1:]])
        said = (*self.done, f"repeated {times} times")
        return Log(time, self.joints, whole, done=said)


def of_function(
    gait: Callable[[float], Mapping[str, float]], duration: float, rate: float = 200.0
) -> Log:
    """The log of a gait that gives the angle of each joint [rad] at a time [s]."""
    if not 0 < duration <= LONGEST or not 1 <= rate <= 1e4:
        raise ValueError(f"{duration} s at {rate} rows a second; give a duration")
    time = np.arange(round(duration * rate) + 1) / rate
    rows = [dict(gait(float(t))) for t in time]
    joints = tuple(rows[0])
    if any(row.keys() != rows[0].keys() for row in rows):
        raise ValueError("gait(t) names other joints at other times")
    return Log(time, joints, np.array([[float(r[j]) for j in joints] for r in rows]))


def read_log(
    path: Path, joints: Sequence[str], legs: Sequence[int], angles: Reader | str = ""
) -> Log:
    """Read a log from a file of anybody.

    Args:
        path: The table, its columns parted by commas, semicolons or tabs.
        joints: Names of the robot's joints that may have a column.
        legs: Numbers of its legs.
        angles: What the columns of joints are in: `degrees`, where all angles of the
            file are, or a function from a joint and its numbers to radians.

    Raises:
        UsageError: It is no such table, or too large; a column is nothing of the robot,
            a number not finite or not an angle, or time does not ascend.
        OSError: It cannot be read.
    """
    try:
        return _log(*_table(path), tuple(joints), tuple(legs), angles)
    except (ValueError, csv.Error) as error:
        raise UsageError.at(str(path), error, "correct the file") from error


def _table(path: Path) -> tuple[list[str], Array]:
    """Names of the columns and their numbers, (n, columns), NaN where cells are empty.

    A file that is no table of numbers is a ValueError.
    """
    text = read_file(path, LARGEST).decode("utf-8-sig")
    first = text.partition("\n")[0]
    parted = max(",;\t", key=first.count)
    lines = (row for row in csv.reader(text.splitlines(), delimiter=parted) if row)
    names = [name.strip() for name in next(lines, [])]
    if twice := {name for name in names if names.count(name) > 1}:
        raise ValueError(f"column {min(twice)!r} comes twice")
    if TIME not in names:
        raise ValueError("no column 'time'; begin with a line of names: time, JOINT")
    cells: list[list[float]] = []
    for number, row in enumerate(lines, 1):
        if len(row) != len(names):
            raise ValueError(f"row {number} has {len(row)} of {len(names)} columns")
        if number > MOST_ROWS:
            raise ValueError(f"more than {MOST_ROWS} rows; give a part of it")
        cells.append([_number(*cell, number) for cell in zip(names, row, strict=True)])
    if len(cells) < 2:
        raise ValueError(f"{len(cells)} rows of numbers; give two at least")
    return names, np.array(cells)


def _number(name: str, cell: str, row: int) -> float:
    text = cell.strip().lower()
    if text in ("", "nan"):
        return nan
    try:
        value = float(text)
    except ValueError:
        value = inf
    if abs(value) == inf:
        raise ValueError(f"{cell.strip()[:40]!r} in row {row}, column {name!r}")
    return value


def _log(
    names: list[str],
    table: Array,
    joints: tuple[str, ...],
    legs: tuple[int, ...],
    angles: Reader | str,
) -> Log:
    """The log in a table; what contradicts the robot or itself is a ValueError."""
    columns = dict(zip(names, table.T, strict=True))
    time = columns.pop(TIME)
    _check_time(time)
    commanded = tuple(name for name in names if name in joints)
    known = [
        *joints,
        *(MEASURED + joint for joint in joints),
        *(BODY + part for part in (*POSE, *LEAN)),
        *(f"{CONTACT}{leg}" for leg in legs),
    ]
    for name in columns:
        if name not in known:
            what = "the robot has no joint" if "." not in name else "there is no column"
            raise ValueError(f"{what} {name!r}; {did_you_mean(name, known)}")
    if not commanded:
        raise ValueError(f"no column of a joint; give one of {', '.join(joints)}")

    def turned(name: str, joint: str = "") -> Array:
        column = columns[name]
        if callable(angles) and joint:
            return angles(joint, column)
        return np.radians(column) if angles == "degrees" else column

    start = time - time[0]
    said = list(_clock(time))
    asked = [_bridged(start, turned(j, j), j, said) for j in commanded]
    _check_angles(start, commanded, np.stack(asked, axis=1))
    measured = {j: turned(n, j) for j in commanded if (n := MEASURED + j) in columns}
    body = {
        part: turned(BODY + part) if part in TURNED else columns[BODY + part]
        for part in (*POSE, *LEAN)
        if BODY + part in columns
    }
    if body.keys() & {"x", "y"} and not body.keys() >= {"x", "y"}:
        raise ValueError("only one of body.x and body.y; give both")
    return Log(
        time=start,
        joints=commanded,
        commanded=np.stack(asked, axis=1),
        measured=_parts(measured, commanded),
        pose=_parts(body, POSE),
        lean=_parts(body, LEAN),
        contact={
            leg: columns[name] for leg in legs if (name := f"{CONTACT}{leg}") in columns
        },
        done=tuple(said),
    )


def _parts(columns: Mapping[str, Array], names: Sequence[str]) -> Array | None:
    """Some columns, those that are missing without numbers; None if all are."""
    found = [columns.get(name) for name in names]
    rows = next((len(column) for column in found if column is not None), None)
    if rows is None:
        return None
    empty = np.full(rows, nan)
    return np.stack([empty if c is None else c for c in found], axis=1)


def _check_time(time: Array) -> None:
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0]) + 1
        raise ValueError(f"no time in row {row}; give each row its time [s]")
    if (back := np.diff(time) <= 0).any():
        row = int(back.argmax())
        raise ValueError(
            f"time goes from {time[row]:.9g} s to {time[row + 1]:.9g} s in row "
            f"{row + 2}; sort the rows, and keep one a moment"
        )
    if (length := time[-1] - time[0]) > LONGEST:
        raise ValueError(
            f"it lasts {length:.6g} s; give at most {LONGEST:g} s, with time in seconds"
        )


def _clock(time: Array) -> Iterator[str]:
    """What is said of the times of rows."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    if time[0] != 0:
        yield f"time begins at {time[0]:.6g} s and is counted from there"
    if (gaps := steps > GAP * usual).any():
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


def _bridged(time: Array, angle: Array, joint: str, said: list[str]) -> Array:
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


def _check_angles(time: Array, joints: Sequence[str], angles: Array) -> None:
    """Refuse angles that no joint takes: those of other units, or wild ones."""
    row, column = map(int, np.unravel_index(np.abs(angles).argmax(), angles.shape))
    if abs(angle := angles[row, column]) > FARTHEST:
        raise ValueError(
            f"{joints[column]!r} comes to {angle:.4g} rad in row {row + 1}, at "
            f"{time[row]:.4g} s; give --units where these are no radians, or correct it"
        )


def written(log: Log) -> str:
    """The text of a log's commands, which `read_log` reads back with every digit."""
    head = ",".join((TIME, *(_quoted(joint) for joint in log.joints)))
    rows = np.column_stack([log.time, log.commanded]).tolist()
    return "\n".join([head, *(",".join(map(repr, row)) for row in rows), ""])


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"\r\n') else name
