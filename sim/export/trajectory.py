"""Commands as a `trajectory_msgs/JointTrajectory` in YAML, as ROS 2 takes them."""

from __future__ import annotations

import json

import numpy as np
import yaml

from sim.export.servo_commands import ServoCommands

SECOND = 1_000_000_000  # [ns]
LOADER = getattr(
    yaml, "CSafeLoader", yaml.SafeLoader
)  # the one in C is 10 times faster


def write_trajectory(commands: ServoCommands) -> str:
    """The trajectory, one line a point; angles to a billionth of a radian."""
    lines = [f"joint_names: {json.dumps(commands.joints)}", "points:"]
    for number, row in enumerate(commands.angles.tolist()):
        sec, nanosec = divmod(round(number * SECOND / commands.rate), SECOND)
        positions = ", ".join(f"{angle:z.9f}" for angle in row)
        lines.append(
            f"- {{positions: [{positions}], "
            f"time_from_start: {{sec: {sec}, nanosec: {nanosec}}}}}"
        )
    return "\n".join(lines) + "\n"


def read_trajectory(text: str) -> ServoCommands:
    """Read what `write_trajectory` wrote; any other text is a ValueError."""
    try:
        read = yaml.load(text, Loader=LOADER)  # noqa: S506
        points = read["points"]
        last = points[-1]["time_from_start"]
        duration = last["sec"] + last["nanosec"] / SECOND
        angles = np.array([point["positions"] for point in points], dtype=float)
    except (yaml.YAMLError, KeyError, IndexError, TypeError) as error:
        raise ValueError(f"no trajectory, {error}") from error
    if len(points) < 2:
        raise ValueError("needs two points at least")
    rate = (len(points) - 1) / duration
    return ServoCommands(tuple(read["joint_names"]), rate, angles)
