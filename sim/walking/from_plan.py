"""The scenario of a plan that exists already: its path is that of the plan."""

from __future__ import annotations

from typing import Any

from models import Robot, equations
from planner import Plan
from sim.scenarios.body_path import waypoints
from sim.scenarios.scenario import Scenario


def scenario_of(robot: Robot, plan: Plan, **changes: Any) -> Scenario:
    """The scenario that a plan of a robot carries out.

    Args:
        robot: Robot that the plan is for.
        plan: Flows of its equations.
        **changes: Settings that are not to have their defaults.

    Raises:
        UsageError: If a setting is unknown or impossible.
    """
    printed = plan.elements == equations(robot, "paper").elements
    shipped = robot.is_shipped
    return Scenario(
        **{
            "name": "plan",
            "robot": robot.name if shipped else str(robot.path.resolve()),
            "fields": "paper" if printed else "lifted",
            "segments": len(plan.segment_ends),
            "path": waypoints(plan.nominal[:, :3].tolist()),
        }
        | changes
    )
