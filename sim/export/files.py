"""Files of commands in every format: written, and read back."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from models import JointServo
from planner.support import read_file
from sim.errors import UsageError
from sim.export.formats import (
    read_angles,
    read_header,
    read_ticks,
    read_trajectory,
    write_angles,
    write_header,
    write_ticks,
    write_trajectory,
)
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import ServoTable, servo_table
from sim.export.source import Source
from sim.folder import whole

LARGEST = 10**9  # bytes
PWM = {"csv": None, "ros2": None, "header": True, "dynamixel": False}  # None: angles


def servos(
    source: Source,
    form: str,
    given: Mapping[str, JointServo] | None = None,
    *,
    microseconds: bool = False,
    rate: float = 0.0,
) -> ServoTable:
    """The servos that a walk is exported for: its card's, unless others are given.

    The rate is that of a walk that has none of its own. A joint without a servo is a
    UsageError.
    """
    missing = [] if given is None else [j for j in source.joints if j not in given]
    if missing:
        raise UsageError(
            f"no servo for joint {missing[0]!r}",
            "--servo-table",
            "give each of the robot's joints a servo of its name",
        )
    make, rate = source.servo.name, source.servo.rate or rate
    table = servo_table(source.run.card, source.joints, make, PWM[form], given, rate)
    return table.in_microseconds() if microseconds else table


def write(
    path: Path, form: str, source: Source, commands: ServoCommands, table: ServoTable
) -> None:
    """Write commands; a joint that leaves its servo's range is a UsageError."""
    table.require_range(commands)
    if form == "csv":
        text = write_angles(commands)
    elif form == "ros2":
        text = write_trajectory(commands)
    elif form == "dynamixel":
        text = write_ticks(commands, table)
    else:
        scenario, robot = source.run.summary.scenario, source.run.summary.robot
        title = f"{scenario} on {robot}, planned by stratawalk."
        text = write_header(commands, table, title=title, name=scenario, file=path.name)
    content = text.encode()
    with whole(path, len(content)) as part:
        part.write_bytes(content)


def read(path: Path, form: str, table: ServoTable) -> ServoCommands:
    """Read what `write` wrote; another file is a ValueError."""
    text = read_file(path, LARGEST).decode()
    if form == "csv":
        return read_angles(text)
    if form == "ros2":
        return read_trajectory(text)
    return (read_ticks if form == "dynamixel" else read_header)(text, table)
