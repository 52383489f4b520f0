"""Tables of servos as ROS packages have them, in YAML.

Each servo has `name` (of its joint), `id`, `ticks` over `max_radians`, `center`, `sign`
and `offset`, in a list or in a table by any keys, on their own or under `SERVOS`.
"""

import re
from math import radians, tau
from pathlib import Path
from typing import Any

import yaml

from models import JointServo
from models.description import Table
from planner.support import read_file
from sim.errors import UsageError, telling

DECIMAL = re.compile(r"[-+]?(?!0\d)(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
ROS = "name", "id", "ticks", "center", "max_radians", "sign", "offset"  # of a servo
REMEDY = "give every servo name, id, ticks, center, max_radians, sign, offset"


class RosLoader(yaml.SafeLoader):  # type: ignore[misc]
    """YAML with rosparam's degrees, without aliases: gigabytes in a line."""

    def compose_node(self, parent: yaml.Node, index: object) -> yaml.Node:
        """The next node, which must stand there itself."""
        if self.check_event(yaml.AliasEvent):
            place = self.peek_event().start_mark
            raise yaml.MarkedYAMLError(None, None, "write aliases out", place)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> Any:
        """A table in which no key stands twice, since the last would count."""
        pairs = node.value if isinstance(node, yaml.MappingNode) else []
        seen = set[str]()
        for key, _ in pairs:
            if (name := str(key.value)) in seen:
                what = f"{name!r} stands there twice"
                raise yaml.MarkedYAMLError(None, None, what, key.start_mark)
            seen.add(name)
        return super().construct_mapping(node, deep)


def _number(loader: yaml.SafeLoader, node: yaml.Node) -> float:
    """A decimal number; YAML 1.1 has 010 for 8 and 1:10 for 70, which nobody means."""
    if not DECIMAL.fullmatch(text := str(node.value)):
        what = f"{text} is no decimal number, such as 10"
        raise yaml.MarkedYAMLError(None, None, what, node.start_mark)
    return int(text) if text.lstrip("+-").isdecimal() else float(text)


RosLoader.add_implicit_resolver(  # 1e-3, which YAML 1.1 takes for text
    "tag:yaml.org,2002:float", re.compile(rf"{DECIMAL.pattern}\Z"), [*"-+.0123456789"]
)
for tag in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float", "!radians"):
    RosLoader.add_constructor(tag, _number)
RosLoader.add_constructor("!degrees", lambda *given: radians(_number(*given)))


def read_ros_table(path: Path) -> dict[str, JointServo]:
    """Read the servos of a robot, by the names of their joints."""
    with telling("cannot be read", path, "give a YAML file", UsageError):
        text = read_file(path, 10**5)  # bytes, of which the reader takes a second
    try:
        read = yaml.load(text, Loader=RosLoader)  # noqa: S506
    except (LookupError, AttributeError) as error:  # of a tag such as !!bool
        raise UsageError("a value not of its tag !!", str(path), REMEDY) from error
    except (yaml.YAMLError, ValueError, RecursionError, OverflowError) as error:
        reason = " ".join(str(error).split())
        raise UsageError(f"not YAML, {reason}", str(path), REMEDY) from error
    listed = read.get("SERVOS", read) if isinstance(read, dict) else read
    servos = list(listed.values()) if isinstance(listed, dict) else listed
    if not (isinstance(servos, list) and servos):
        raise UsageError("no servos", str(path), REMEDY)
    table: dict[str, JointServo] = {}
    try:
        for number, servo in enumerate(servos, start=1):
            joint, found = _servo(Table(servo, f"servo {number}", ROS))
            if joint in table:
                raise ValueError(f"servo {number}: {joint!r} is there twice")
            table[joint] = found
    except ValueError as error:
        raise UsageError(str(error), str(path), REMEDY) from error
    return table


def _servo(given: Table) -> tuple[str, JointServo]:
    ticks, turned = given.number("ticks"), given.number("max_radians")
    center, sign = given.number("center"), given.number("sign", 1)
    offset = given.number("offset", 0.0)
    if not (ticks > 0 and 0 < turned <= 2 * tau):
        raise ValueError(f"{given.where}: ticks must be positive, max_radians to 12.5")
    ends = sorted(
        offset + sign * (count - center) * turned / ticks for count in (0, ticks - 1)
    )
    numbers = {"sign": sign, "offset": offset, "center": center}
    numbers |= {"channel": given.whole("id"), "counts_per_radian": ticks / turned}
    limits = ends[0], ends[1]
    return str(given.get("name")), given.make(JointServo, limits=limits, **numbers)
