"""A robot without a simulation: poses come in, joint angles of the next segment go out.

Each line that comes in is what a camera saw when the robot stood still: x and y [m] and
yaw [rad] from where it started, or nothing where it was not seen. Each line that goes
out is where all joints must move next [rad], one after the other.

Example:
    echo "0.004 0.001 0.02" | python examples/feedback_from_a_camera.py
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from math import radians

import numpy as np

import models
import planner
from sim import Feedback, Sensing

LIFT = 0.2  # angle by which legs in the air are raised [rad]


def tell(robot: models.Robot, swing: np.ndarray, raised: Sequence[float]) -> None:
    """Print the angle of every joint [rad]."""
    angles = robot.leg_angles(swing, np.array(raised))
    print(json.dumps({joint: round(float(at), 5) for joint, at in angles.items()}))


def main(poses: Iterable[str] = sys.stdin) -> None:
    """Walk to (40 mm, 0) in ten segments, as far as poses come."""
    robot = models.load("hexapod")
    equations = models.equations(robot)
    feedback = Feedback(Sensing(position=0.002, yaw=radians(1)), radius=0.22)
    lines = iter(poses)
    for segment in range(10):
        meant = feedback.aim([0.004 * (segment + 1), 0.0, 0.0])
        swing = np.zeros(len(robot.groups))
        for flow in planner.plan(equations, planner.line((0, 0, 0), meant), 1).flows:
            raised = [LIFT * (group not in flow.stratum) for group in robot.groups]
            for share in (0.0, flow.duration):  # first change legs, then swing them
                swing += share * np.array(equations.swings[flow.field])
                tell(robot, swing, raised)
        tell(robot, swing, [0.0] * len(robot.groups))  # stand, to be seen
        if (seen := next(lines, None)) is None:
            break
        feedback.moved(meant, seconds=6.0)
        feedback.seen([float(word) for word in seen.split()] or None)
        print("estimated at", feedback.pose.round(4), file=sys.stderr)


if __name__ == "__main__":
    main()
