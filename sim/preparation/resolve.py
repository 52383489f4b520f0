"""A scenario with all settings filled in that it left to its robot."""

from __future__ import annotations

from dataclasses import replace

from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario


def resolved(setup: Setup, scenario: Scenario, robot: str) -> Scenario:
    """The scenario with the settings of its robot; it gives the same walk.

    Some settings remain open: the height of a lift, which the card gives as an angle,
    servos that differ from joint to joint, and bounds that are not asked for.

    Args:
        setup: The scenario with everything decided.
        scenario: The scenario before its path was divided to keep its bounds.
        robot: Name or file of the robot.
    """
    servo = setup.world.servo
    stiffness, damping = (None, None) if servo is None else servo
    given = scenario.servo_stiffness, scenario.servo_damping
    return replace(
        scenario,
        robot=robot,
        stance="centred" if setup.stance == "stepped" else setup.stance,
        servo_stiffness=stiffness if given[0] is None else given[0],
        servo_damping=damping if given[1] is None else given[1],
    )
