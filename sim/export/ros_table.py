"""Servo tables as ROS packages have them, in YAML.

Each servo has `name` (of its joint), `id`, `ticks` over `max_radians`, `center`, `sign`
and `offset`, in a list or in a table by any keys, on their own or under `SERVOS`.
"""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Any

import yaml

from models import JointServo
from planner.support import read_file
from sim.errors import UsageError

KEYS = ("name", "id", "ticks", "center", "max_radians", "sign", "offset")
OPTIONAL = {"sign": 1, "offset": 0.0}
REMEDY = f"give every servo {', '.join(KEYS)}"


class RosLoader(yaml.SafeLoader):  # type: ignore[misc]
    """YAML with the angles in degrees that rosparam knows."""


def _angle(loader: yaml.SafeLoader, node: yaml.Node) -> float:
    return float(str(loader.construct_scalar(node)))  # type: ignore[arg-type]


RosLoader.add_constructor("!degrees", lambda *given: radians(_angle(*given)))
RosLoader.add_constructor("!radians", _angle)


def read_ros_table(path: Path) -> dict[str, JointServo]:
    """Read the servos of a robot, by the names of their joints."""
    try:
        read = yaml.load(read_file(path), Loader=RosLoader)  # noqa: S506
    except OSError as error:
        what = f"cannot be read, {error.strerror}"
        raise UsageError(what, str(path), "give a YAML file") from error
    except (yaml.YAMLError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise UsageError(f"not YAML, {reason}", str(path), REMEDY) from error
    listed = read.get("SERVOS", read) if isinstance(read, dict) else read
    servos = list(listed.values()) if isinstance(listed, dict) else listed
    if not (isinstance(servos, list) and servos):
        raise UsageError("no servos", str(path), REMEDY)
    table: dict[str, JointServo] = {}
    for number, servo in enumerate(servos, start=1):
        try:
            joint, read_servo = _servo(servo)
            if joint in table:
                raise ValueError(f"{joint!r} is there twice")
        except (ValueError, TypeError) as error:
            raise UsageError(f"servo {number}: {error}", str(path), REMEDY) from error
        table[joint] = read_servo
    return table


def _servo(given: Any) -> tuple[str, JointServo]:
    if not isinstance(given, dict):
        raise ValueError(f"{given!r} is not a table")
    values = OPTIONAL | given
    if missing := [key for key in KEYS if key not in values]:
        raise ValueError(f"{', '.join(missing)} missing")
    ticks, turned = _number(values, "ticks"), _number(values, "max_radians")
    center, sign = _number(values, "center"), _number(values, "sign")
    offset, number = _number(values, "offset"), values["id"]
    if isinstance(number, bool) or not isinstance(number, int):
        raise ValueError(f"id must be a whole number, got {number!r}")
    if not (ticks > 0 and turned > 0):
        raise ValueError("ticks and max_radians must be positive")
    ends = sorted(
        offset + sign * (count - center) * turned / ticks for count in (0, ticks - 1)
    )
    return str(values["name"]), JointServo(
        channel=number,
        sign=sign,
        center=center,
        offset=offset,
        counts_per_radian=ticks / turned,
        limits=(ends[0], ends[1]),
    )


def _number(values: dict[str, Any], key: str) -> float:
    value = values[key]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{key} must be a number, got {value!r}")
    return float(value)
