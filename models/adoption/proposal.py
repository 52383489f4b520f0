"""Another posture for a robot that has a card, and what it could do in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.adoption.draft import draft_card
from models.adoption.source import Source
from models.description.card_file import parse_card
from models.description.robot import Robot
from models.errors import ModelError
from models.motion.mobility import Mobility, mobility_of
from models.motion.robot_equations import equations
from planner import PlannerError

UNITS = {"x": "metre forward", "y": "metre sideways", "theta": "radian of yaw"}


@dataclass(frozen=True)
class Proposal:
    """Groups and posture that `draft_card` would give a robot.

    Attributes:
        turned: How far its legs are turned at most from where they stand [rad].
        mobility: What the robot can do then.
    """

    turned: float
    mobility: Mobility

    def __str__(self) -> str:
        costs = (
            f"{cost.strokes:,.0f} strokes a {UNITS[cost.direction]}"
            for cost in self.mobility.costs
        )
        return (
            f"with its legs turned by up to {np.rad2deg(self.turned):.0f} degrees it "
            f"would take {', '.join(costs)}"
        )


def propose(robot: Robot) -> Proposal | None:
    """Try the groups and the posture that adopting the robot anew would give.

    Args:
        robot: Robot that lacks a direction.

    Returns:
        None if there are none in which it lacks nothing.
    """
    try:
        draft = draft_card(Source(robot.path, robot.path, None))
        card = parse_card(draft.card, "draft")
        posed = replace(robot, card_text=draft.card, card=card)
        found = mobility_of(posed, equations(posed))
    except (ModelError, PlannerError):
        return None
    if found.lacking:
        return None
    turned = float(np.abs(draft.gait.turns).max())
    return Proposal(turned, found)
