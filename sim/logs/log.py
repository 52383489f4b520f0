"""Logs: joint motion over time, and what was measured on a real robot meanwhile.

A file is a table of numbers with a line of names: `time` [s], a column a joint with its
commands, and beside them `measured.JOINT`, what is in `BODY` [m], and `contact.LEG` (0
or 1). Empty cells are gaps. It holds numbers alone; nothing is carried out.
"""

import csv
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from math import inf, nan, radians
from pathlib import Path

import numpy as np

from planner import Array
from planner.support import did_you_mean, read_file
from sim.errors import UsageError, message
from sim.folder import csv_lines, csv_text

LARGEST_LOG, LONGEST_ROW = 10**8, 10**7  # bytes
MOST_NUMBERS = 5 * 10**6  # which take some seconds to read
SHORTEST_LOG, LONGEST_LOG = 0.01, 600.0  # [s]
SHORTEST_STEP = 1e-6  # [s], between rows
FARTHEST = 4 * np.pi  # [rad]
LARGEST = 1e6  # of what was measured, in whatever unit
JITTER = 0.05  # of a step of the clock, that is mentioned
CLOCK_GAP = 2.5  # steps of the clock; what is longer is a gap
TIME, MEASURED, CONTACT = "time", "measured.", "contact."
BODY = {
    "pose": ("body.x", "body.y", "body.yaw"),
    "lean": ("body.roll", "body.pitch"),
    "spread": ("body.x.error", "body.y.error", "body.yaw.error"),
}
ANGLES = ("body.yaw", "body.roll", "body.pitch", "body.yaw.error")

Gait = Callable[[float], Mapping[str, float]]  # joint angles [rad] at a time [s]
Readers = Mapping[str, Callable[[Array], Array]]  # angles [rad] of joints' numbers


@dataclass(frozen=True, eq=False)
class Log:
    """Commanded joint angles over time, and what was measured meanwhile.

    Rows are ascending in time and start at 0. Commands are finite; measured numbers are
    NaN where the log has a gap, and None where it has no such columns.

    Raises:
        ValueError: Arrays contradict one another, time does not ascend from 0, or a
            command is not finite.
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
            raise ValueError("fewer than two rows; give two at least")
        if self.commanded.shape != (rows, width):
            raise ValueError(f"commands {self.commanded.shape} for {(rows, width)}")
        if not np.isfinite(self.commanded).all():
            raise ValueError("a command is not a finite number")
        if self.time[0] or (np.diff(self.time) <= 0).any():
            raise ValueError("time does not ascend from 0")
        if (most := float(np.abs(self.commanded).max())) > FARTHEST:
            raise ValueError(f"a command of {most:.3g} rad; give angles in radians")

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1])

    def at(self, time: Array) -> Array:
        """Commands at times (T,), evenly between rows, held beyond the ends, (T, J)."""
        return np.stack([np.interp(time, self.time, a) for a in self.commanded.T], 1)

    def repeated(self, times: int) -> "Log":
        """The same motion several times over; what was measured is left out.

        The last row begins the next period, so that it must be like the first one.
        """
        apart = float(np.abs(self.commanded[-1] - self.commanded[0]).max())
        if times > 1 and apart > radians(1):
            raise ValueError(message("not_periodic", apart=apart))
        size = self.time.size * (1 + len(self.joints))
        most = int(min(LONGEST_LOG / self.duration, MOST_NUMBERS / size))
        if times > max(most, 1):
            raise ValueError(f"{times} times is too long; give --repeat {most} at most")
        starts = np.arange(times)[:, None] * self.time[-1]
        time = np.append(starts + self.time[:-1], times * self.time[-1])
        rows = np.vstack([*[self.commanded[:-1]] * times, self.commanded[-1:]])
        done = (*self.done, f"repeated {times} times")
        return Log(time, self.joints, rows, done=done)


def of_function(gait: Gait, duration: float, rate: float = 200.0) -> Log:
    """The log of a gait that gives the angle of each joint [rad] at a time [s]."""
    if not 0 < duration <= LONGEST_LOG or not 1 <= rate <= 1e4:
        raise ValueError(f"{duration} s at {rate} rows a second; give a duration")
    time = np.arange(round(duration * rate) + 1) / rate
    rows = [dict(gait(float(t))) for t in time]
    joints = tuple(rows[0])
    if not joints or any(row.keys() != rows[0].keys() for row in rows):
        raise ValueError("gait(t) names no joint, or different ones at different times")
    return Log(time, joints, np.array([[float(r[j]) for j in joints] for r in rows]))


def require_joints(named: Sequence[str], known: Sequence[str]) -> None:
    """Refuse, with a ValueError, a joint that a robot lacks."""
    for name in named:
        if name not in known:
            what = "the robot has no joint" if "." not in name else "there is no column"
            raise ValueError(f"{what} {name!r}; {did_you_mean(name, known)}")


def read_log(
    path: Path, joints: Sequence[str], legs: Sequence[int], angles: Readers | str = ""
) -> Log:
    """Read a log from a file of anybody.

    Args:
        path: The table, its columns parted by commas, semicolons or tabs.
        joints: Names of the robot's joints that may have a column.
        legs: Numbers of its legs.
        angles: What the columns of joints are in: `degrees`, where all angles of the
            file are, or what makes radians of the numbers of each joint.

    Raises:
        UsageError: It cannot be read, is no such table, or too large; a column is
            nothing of the robot, a number not finite or not an angle, or time does not
            ascend.
    """
    try:
        return _log(_table(path, joints), joints, legs, angles)
    except OSError as error:
        what, remedy = f"no such log, {error.strerror}", "give a log, or a part of one"
        raise UsageError(what, str(path), remedy) from error
    except (ValueError, csv.Error) as error:
        raise UsageError.at(str(path), error, "correct the file") from error


def _table(path: Path, joints: Sequence[str] = ()) -> dict[str, Array]:
    """Columns of numbers by name, NaN where cells are empty."""
    text = read_file(path, LARGEST_LOG).decode("utf-8-sig", "replace")
    if "\0" in text:
        raise ValueError("it has zero bytes, as UTF-16 does; save it in UTF-8, without")
    head = text.lstrip("\r\n").partition("\n")[0].replace('"', "").strip("\r")
    if text.count("\n") > MOST_NUMBERS or max(map(len, text.split("\n"))) > LONGEST_ROW:
        raise ValueError(f"more than {MOST_NUMBERS} lines, or one that is too long")
    parted = max(",;\t", key=lambda m: (m + TIME + m in m + head + m, head.count(m)))
    lines = filter(None, csv_lines(text, parted))
    names = [n if n in joints else n.strip() for n in next(lines, [])]
    if TIME not in names:
        raise ValueError("no column 'time'; begin with a line of names: time, JOINT")
    if twice := Counter(filter(None, names)) - Counter(set(names)):
        raise ValueError(f"column {min(twice)!r} comes twice")
    cells: list[list[float]] = []
    for number, row in enumerate(lines, 1):
        if len(row) != len(names):
            raise ValueError(f"row {number} has {len(row)} of {len(names)} columns")
        if number * len(names) > MOST_NUMBERS:
            raise ValueError(f"more than {MOST_NUMBERS} numbers; give a part of it")
        cells.append([_number(*cell, number) for cell in zip(names, row, strict=True)])
    if len(cells) < 2:
        raise ValueError("fewer than two rows of numbers; give two at least")
    columns = zip(names, np.array(cells).T, strict=True)
    return {n: numbers for n, numbers in columns if n or np.isfinite(numbers).any()}


def _number(name: str, cell: str, row: int) -> float:
    cell = cell.strip()
    try:  # Python reads other digits, too, and 1_0
        value = float(cell or nan) if cell.isascii() and "_" not in cell else inf
    except ValueError:
        value = inf
    if abs(value) == inf:
        raise ValueError(f"{cell[:40]!r} in row {row}, column {name!r}, is no number")
    return value


def _log(
    columns: dict[str, Array],
    joints: Sequence[str],
    legs: Sequence[int],
    angles: Readers | str,
) -> Log:
    _check_time(time := columns.pop(TIME))
    contacts = {leg: f"{CONTACT}{leg}" for leg in legs}
    turning = (*joints, *(MEASURED + joint for joint in joints), *BODY["lean"])
    require_joints([*columns], [*turning, *chain(*BODY.values()), *contacts.values()])
    columns = {k: v for k, v in columns.items() if k in joints or np.isfinite(v).any()}
    commanded = tuple(name for name in columns if name in joints)
    if not commanded:
        raise ValueError(f"no column of a joint; give one of {', '.join(joints)}")
    for name, numbers in columns.items():
        if not isinstance(angles, str) and (j := name.removeprefix(MEASURED)) in joints:
            columns[name] = angles[j](numbers)
        elif angles == "degrees" and name in (*turning, *ANGLES):
            columns[name] = np.radians(numbers)
    start, done = time - time[0], [*_said_of_clock(time)]
    of = {c: c[:-6] for c in BODY["spread"]} | {MEASURED + j: j for j in joints}
    alone = [c for c in columns if of.get(c, c) not in columns]
    done += (f"{c} is left out; there is no {of[c]}" for c in alone)
    asked = np.stack([_bridged(start, columns[j], j, done) for j in commanded], axis=1)
    for name, numbers in columns.items():
        row = int(np.nanargmax(np.abs(numbers)))
        if name in turning and abs(numbers[row]) > FARTHEST:
            facts = {"angle": numbers[row], "row": row + 1, "time": start[row]}
            raise ValueError(message("far", name=name, **facts))
        if (np.abs(numbers) > LARGEST).any():
            raise ValueError(f"a number beyond {LARGEST:g} in column {name!r}")
        if name in BODY["spread"] and (numbers < 0).any():
            raise ValueError(f"a negative standard error in column {name!r}")
        if name in contacts.values() and not {*numbers[numbers == numbers]} <= {0, 1}:
            raise ValueError(f"column {name!r} has numbers other than 0 and 1")
    if ("body.x" in columns) != ("body.y" in columns):
        raise ValueError("only one of body.x and body.y; give both")
    return Log(
        time=start,
        joints=commanded,
        commanded=asked,
        measured=_stacked(columns, [MEASURED + joint for joint in commanded]),
        **{part: _stacked(columns, names) for part, names in BODY.items()},
        contact={leg: columns[c] for leg, c in contacts.items() if c in columns},
        done=tuple(done),
    )


def _check_time(time: Array) -> None:
    """Refuse times [s] that are missing, do not ascend, or last too long."""
    if not (known := np.isfinite(time)).all():
        raise ValueError(f"no time in row {known.argmin() + 1}; give each its time [s]")
    if (back := np.diff(time) < 0.999 * SHORTEST_STEP).any():  # rounded
        row = int(back.argmax())
        facts = {"before": time[row], "after": time[row + 1], "row": row + 2}
        raise ValueError(message("back", least=SHORTEST_STEP, **facts))
    if not SHORTEST_LOG <= (length := time[-1] - time[0]) <= LONGEST_LOG:
        facts = {"least": SHORTEST_LOG, "most": LONGEST_LOG}
        raise ValueError(message("lasting", length=length, **facts))


def _said_of_clock(time: Array) -> Iterator[str]:
    steps = np.diff(time)
    usual = float(np.median(steps))
    if time[0]:
        yield f"time begins at {time[0]:.6g} s and is counted from there"
    if (gaps := steps > CLOCK_GAP * usual).any():
        yield message("gaps", longest=steps.max(), count=gaps.sum())
    regular = steps[~gaps]
    if len(regular) and regular.std() > JITTER * usual:
        yield message("jitter", spread=1e3 * regular.std(), usual=1e3 * usual)


def _bridged(time: Array, angle: Array, joint: str, done: list[str]) -> Array:
    """Commands with even passages where cells are empty."""
    there = np.isfinite(angle)
    if there.all():
        return angle
    if not there.any():
        raise ValueError(f"column {joint!r} is empty; leave it out")
    rows = np.flatnonzero(there)
    held = time[rows[0]] - time[0], time[-1] - time[rows[-1]]  # at the first and last
    longest = max(*held, *np.diff(time[rows])[np.diff(rows) > 1])
    done.append(message("bridged", joint=joint, count=(~there).sum(), longest=longest))
    return np.interp(time, time[there], angle[there])


def _stacked(columns: Mapping[str, Array], names: Sequence[str]) -> Array | None:
    """Some columns, those that are missing without numbers; None if all are."""
    if not (found := [columns[name] for name in names if name in columns]):
        return None
    return np.stack([columns.get(name, nan * found[0]) for name in names], axis=1)


def written(log: Log) -> str:
    """The text of a log, which `read_log` reads back with every digit."""
    names, columns = [TIME, *log.joints], [log.time, *log.commanded.T]
    for part, own in {"measured": [MEASURED + j for j in log.joints], **BODY}.items():
        if (values := getattr(log, part)) is not None:
            names += own
            columns += [*values.T]
    names += (f"{CONTACT}{leg}" for leg in log.contact)
    columns += log.contact.values()
    return csv_text([names, *np.stack(columns, axis=1).tolist()])
