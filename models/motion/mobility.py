"""Where the swings that steer a robot can take it, and why they take it nowhere else.

Two swings move the body, each about its pivot or straight ahead, and their bracket
moves it across, unless the pivots coincide or neither swing turns the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np

from models.contact.kinematics import Kinematics
from models.description.robot import Robot
from models.motion.equations_of_motion import POSE
from models.motion.robot_equations import Equations
from planner import PlannerError
from planner.extension import AFFORDABLE, DirectionCost, stroke_costs

WAYS = dict(zip(map(str, POSE), ("go forward", "go sideways", "turn"), strict=True))
STRAIGHT = 1e-3  # rad of yaw while the body moves by the size of its stance


@dataclass(frozen=True)
class Mobility:
    """What the swings of a robot can do.

    Attributes:
        costs: Strokes for a metre of x and y, and for a radian of yaw.
        lacking: What the robot cannot do, such as `go sideways`; empty if nothing.
        reason: Why it cannot, in words; empty if nothing lacks.

    Example:
        >>> from models import equations, load, mobility_of
        >>> parallel = load("hexapod-parallel")
        >>> [c.direction for c in mobility_of(parallel, equations(parallel)).costs]
        ['x', 'y', 'theta']
    """

    costs: tuple[DirectionCost, ...]
    lacking: tuple[str, ...]
    reason: str


def mobility_of(robot: Robot, described: Equations) -> Mobility:
    """What the swings of a robot, by its equations, can do from where it stands.

    Example:
        >>> from models import equations, load, mobility_of
        >>> robot = load("hexapod")
        >>> mobility_of(robot, equations(robot)).lacking
        ()
    """
    system, elements = described.system, described.elements
    at = np.zeros(system.dimension)
    try:
        found = stroke_costs(system, elements, at, described.strokes)
    except PlannerError:  # the bracket vanishes
        found = stroke_costs(system, elements[:-1], at, described.strokes)
    costs = tuple(cost for cost in found if cost.direction in WAYS)
    reached = {cost.direction for cost in costs if not cost.in_theory_only}
    lacking = tuple(words for name, words in WAYS.items() if name not in reached)
    reason = _reason(robot, described) if lacking else ""
    return Mobility(costs, lacking, reason)


def _reason(robot: Robot, described: Equations) -> str:
    size = Kinematics(robot).reach
    twists = [described.twists[name] for name in described.elements[:2]]
    turning = [abs(yaw) * size > STRAIGHT * hypot(*way) for *way, yaw in twists]
    if not any(turning):
        return (
            "neither of its two strokes turns the body: the legs of a group are "
            "parallel and carry it straight along"
        )
    if all(turning):
        pivots = [(-left / yaw, forward / yaw) for forward, left, yaw in twists]
        (x, y), (u, v) = pivots  # points of the body that strokes leave in place [m]
        apart = hypot(x - u, y - v)
        return (
            f"both strokes turn the body about nearly the same point, ({x:z.3f}, "
            f"{y:z.3f}) m, where the legs of both groups, produced inward, meet: their "
            f"pivots are {1e3 * apart:.3g} mm apart"
        )
    return (
        f"its strokes are short: even {AFFORDABLE:,.0f} of them make no unit of the "
        "directions that are missing"
    )
