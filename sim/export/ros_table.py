"""Servo tables as ROS packages have them, in YAML.

Each servo has `name` (of its joint), `id`, `ticks` over `max_radians`, `center`, `sign`
and `offset`, in a list or in a table by any keys, on their own or under `SERVOS`.
"""

from __future__ import annotations

from math import radians
from pathlib import Path

import yaml

from models import JointServo
from models.description import Table
from planner.support import read_file
from sim.errors import UsageError

YAML_BYTES = 10**5  # bytes, of which the reader takes a second
REMEDY = "give every servo name, id, ticks, center, max_radians, sign, offset"


class RosLoader(yaml.SafeLoader):  # type: ignore[misc]
    """YAML with the angles in degrees that rosparam knows, and without aliases.

    Aliases of aliases are a gigabyte in a line; no servo needs them.
    """

    def compose_node(self, parent: yaml.Node, index: object) -> yaml.Node:
        """The next node, which must stand there itself."""
        if self.check_event(yaml.AliasEvent):
            place = self.peek_event().start_mark
            raise yaml.MarkedYAMLError(None, None, "write aliases out", place)
        return super().compose_node(parent, index)


def _angle(loader: yaml.SafeLoader, node: yaml.Node) -> float:
    return float(str(loader.construct_scalar(node)))  # type: ignore[arg-type]


RosLoader.add_constructor("!degrees", lambda *given: radians(_angle(*given)))
RosLoader.add_constructor("!radians", _angle)


def read_ros_table(path: Path) -> dict[str, JointServo]:
    """Read the servos of a robot, by the names of their joints."""
    try:
        read = yaml.load(read_file(path, YAML_BYTES), Loader=RosLoader)  # noqa: S506
    except OSError as error:
        what = f"cannot be read, {error.strerror}"
        raise UsageError(what, str(path), "give a YAML file") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise UsageError(f"not YAML, {reason}", str(path), REMEDY) from error
    listed = read.get("SERVOS", read) if isinstance(read, dict) else read
    servos = list(listed.values()) if isinstance(listed, dict) else listed
    if not (isinstance(servos, list) and servos):
        raise UsageError("no servos", str(path), REMEDY)
    table: dict[str, JointServo] = {}
    for number, servo in enumerate(servos, start=1):
        try:
            joint, read_servo = _servo(Table(servo, f"servo {number}"))
            if joint in table:
                raise ValueError(f"servo {number}: {joint!r} is there twice")
        except ValueError as error:
            raise UsageError(str(error), str(path), REMEDY) from error
        table[joint] = read_servo
    return table


def _servo(given: Table) -> tuple[str, JointServo]:
    ticks, turned = given.number("ticks"), given.number("max_radians")
    center, sign = given.number("center"), given.number("sign", 1)
    offset = given.number("offset", 0.0)
    if not (ticks > 0 and turned > 0):
        raise ValueError(f"{given.where}: ticks and max_radians must be positive")
    ends = sorted(
        offset + sign * (count - center) * turned / ticks for count in (0, ticks - 1)
    )
    return str(given.get("name")), given.make(
        JointServo,
        channel=given.whole("id"),
        sign=sign,
        center=center,
        offset=offset,
        counts_per_radian=ticks / turned,
        limits=(ends[0], ends[1]),
    )
