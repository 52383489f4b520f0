"""Logs: joint motion over time, and what was measured on a real robot meanwhile.

A file is a table of numbers with a line of names. `time` [s] and a column a joint, by
its name, hold the commands. What was measured may stand beside them: `measured.JOINT`,
`body.x`, `body.y` [m], `body.yaw`, `body.roll`, `body.pitch`, the standard errors
`body.x.error`, `body.y.error`, `body.yaw.error`, and `contact.LEG` (0 or 1).
Empty cells are gaps. What is in a file is numbers alone; nothing is carried out.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, nan, radians
from pathlib import Path

import numpy as np

from planner import Array
from planner.support import did_you_mean, read_file
from sim.errors import UsageError
from sim.logs.checks import LONGEST_LOG, bridged, check_angles, check_time, clock

LARGEST_LOG = 10**8  # bytes
MOST_ROWS = 10**6
TIME, MEASURED, BODY, CONTACT = "time", "measured.", "body.", "contact."
POSE, LEAN = ("x", "y", "yaw"), ("roll", "pitch")
SPREAD = ".error"  # of a column with its standard error
ANGLES = ("yaw", *LEAN)  # columns of the body that are angles

Gait = Callable[[float], Mapping[str, float]]  # joint angles [rad] at a time [s]
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
    spread: Array | None = None  # standard error of the pose, (n, 3)
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

    @property
    def fastest(self) -> float:
        """Highest speed that is commanded to any joint [rad/s]."""
        speed = np.diff(self.commanded, axis=0) / np.diff(self.time)[:, None]
        return float(np.abs(speed).max())

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


def of_function(gait: Gait, duration: float, rate: float = 200.0) -> Log:
    """The log of a gait that gives the angle of each joint [rad] at a time [s]."""
    if not 0 < duration <= LONGEST_LOG or not 1 <= rate <= 1e4:
        raise ValueError(f"{duration} s at {rate} rows a second; give a duration")
    time = np.arange(round(duration * rate) + 1) / rate
    rows = [dict(gait(float(t))) for t in time]
    joints = tuple(rows[0])
    if any(row.keys() != rows[0].keys() for row in rows):
        raise ValueError("gait(t) names other joints at other times")
    return Log(time, joints, np.array([[float(r[j]) for j in joints] for r in rows]))


def require_joints(named: Sequence[str], known: Sequence[str]) -> None:
    """Refuse, with a ValueError, a joint that a robot lacks."""
    for name in named:
        if name not in known:
            what = "the robot has no joint" if "." not in name else "there is no column"
            raise ValueError(f"{what} {name!r}; {did_you_mean(name, known)}")


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
    text = read_file(path, LARGEST_LOG).decode("utf-8-sig")
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
    check_time(time)
    commanded = tuple(name for name in names if name in joints)
    known = [
        *joints,
        *(MEASURED + joint for joint in joints),
        *(BODY + part for part in (*POSE, *LEAN)),
        *(BODY + part + SPREAD for part in POSE),
        *(f"{CONTACT}{leg}" for leg in legs),
    ]
    require_joints([*columns], known)
    if not commanded:
        raise ValueError(f"no column of a joint; give one of {', '.join(joints)}")

    def turned(name: str, joint: str = "") -> Array:
        column = columns[name]
        if callable(angles) and joint:
            return angles(joint, column)
        return np.radians(column) if angles == "degrees" else column

    start = time - time[0]
    said = list(clock(time))
    asked = [bridged(start, turned(j, j), j, said) for j in commanded]
    check_angles(start, commanded, np.stack(asked, axis=1))
    measured = {j: turned(n, j) for j in commanded if (n := MEASURED + j) in columns}
    body = {
        part: turned(BODY + part) if part in ANGLES else columns[BODY + part]
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
        spread=_parts(columns, [BODY + part + SPREAD for part in POSE]),
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


def written(log: Log) -> str:
    """The text of a log, which `read_log` reads back with every digit."""
    columns = {TIME: log.time, **dict(zip(log.joints, log.commanded.T, strict=True))}
    if log.measured is not None:
        names = (MEASURED + joint for joint in log.joints)
        columns |= zip(names, log.measured.T, strict=True)
    errors = tuple(part + SPREAD for part in POSE)
    for parts, values in ((POSE, log.pose), (LEAN, log.lean), (errors, log.spread)):
        if values is not None:
            names = (BODY + part for part in parts)
            columns |= zip(names, values.T, strict=True)
    columns |= {f"{CONTACT}{leg}": column for leg, column in log.contact.items()}
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(np.stack([*columns.values()], axis=1).tolist())
    return text.getvalue()
