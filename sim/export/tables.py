"""Commands as tables in CSV: angles, or ticks of Dynamixel servos."""

from __future__ import annotations

import csv
from collections.abc import Iterable

import numpy as np

from planner import Array
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import ServoTable


def write_angles(commands: ServoCommands) -> str:
    """A column `time` [s] and a column a joint [rad], every digit of every angle."""
    rows = (map(repr, row) for row in commands.angles.tolist())
    return _written(commands.joints, commands.time, rows)


def read_angles(text: str) -> ServoCommands:
    """Read what `write_angles` wrote; any other text is a ValueError."""
    joints, rate, values = _read(text)
    return ServoCommands(joints, rate, values)


def write_ticks(commands: ServoCommands, table: ServoTable) -> str:
    """A column `time` [s] and a column a joint, in the order of the channels."""
    rows = (map(str, row) for row in table.counts(commands).tolist())
    return _written(table.joints, commands.time, rows)


def read_ticks(text: str, table: ServoTable) -> ServoCommands:
    """Read what `write_ticks` wrote for the same servos, or raise ValueError."""
    joints, rate, counts = _read(text)
    if joints != table.joints:
        raise ValueError(f"columns {joints} for joints {table.joints}")
    return table.commands(counts, rate)


def _written(joints: Iterable[str], time: Array, rows: Iterable[Iterable[str]]) -> str:
    lines = [",".join(("time", *joints))]
    lines += (
        ",".join((repr(moment), *row))
        for moment, row in zip(time.tolist(), rows, strict=True)
    )
    return "\n".join(lines) + "\n"


def _read(text: str) -> tuple[tuple[str, ...], float, Array]:
    """Joints, rate and values of a table."""
    (first, *joints), *rows = csv.reader(text.splitlines())
    if first != "time" or len(rows) < 2:
        raise ValueError("needs a column time, and two commands at least")
    values = np.array(rows, dtype=float)
    rate = (len(values) - 1) / (values[-1, 0] - values[0, 0])
    return tuple(joints), float(rate), values[:, 1:]
