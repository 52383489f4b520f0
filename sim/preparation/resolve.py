"""A scenario with nothing left open that a number or a word can say."""

from __future__ import annotations

from dataclasses import replace

from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario


def resolved(setup: Setup, scenario: Scenario, robot: str) -> Scenario:
    """What a scenario left to its robot, filled in; carried out, it gives the same.

    Open remain the height of a lift, which the card says as an angle, servos of which
    one robot has several, and what is not asked for.

    Args:
        setup: What the scenario has come to.
        scenario: Before its path was divided for its bounds.
        robot: What is to name the robot.
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
