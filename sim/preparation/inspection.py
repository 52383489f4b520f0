"""A robot as it can be looked at, whether or not it can walk everywhere.

What it lacks for walking is put into words. A robot that cannot even stand is refused.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from models import (
    Equations,
    Kinematics,
    Mobility,
    ModelError,
    Robot,
    equations,
    mobility_of,
)
from models.adoption import servo_for
from sim.physics.standing import check_standing
from sim.preparation.reach import immobile
from sim.preparation.setup import Setup, lift_angle
from sim.scenarios.scenario import Scenario
from sim.world.changes import changes, overlaps
from sim.world.model import build, load as load_world
from sim.world.servos import joints_without_servo


@dataclass(frozen=True, eq=False)
class Inspected:
    """A robot that stands, with what can be said of it.

    Attributes:
        robot: The robot.
        kinematics: Its kinematics.
        lift_angle: Angle that raises its feet [rad].
        let_down: How far it had to be lowered onto the floor [m].
        equations: Its equations; None if its gait gives it none.
        mobility: What its swings can do; None without equations.
        changed: What is changed in its file before it walks, a sentence each.
        lacks: What it lacks, a sentence each, with what would change that.
    """

    robot: Robot
    kinematics: Kinematics
    lift_angle: float
    let_down: float
    equations: Equations | None
    mobility: Mobility | None
    changed: tuple[str, ...] = ()
    lacks: tuple[str, ...] = ()

    @classmethod
    def of(cls, setup: Setup) -> Inspected:
        """A robot that is set up to walk."""
        return cls(
            robot=setup.robot,
            kinematics=setup.kinematics,
            lift_angle=setup.limits.lift_angle,
            let_down=setup.world.let_down,
            equations=setup.equations,
            mobility=mobility_of(setup.robot, setup.equations),
            changed=changes(setup.robot, setup.scenario),
        )


def inspected(scenario: Scenario, robot: Robot) -> Inspected:
    """Look at a robot; what keeps it from walking is told, not refused.

    Args:
        scenario: Settings of the physics in which it is to stand.
        robot: Robot to look at.

    Raises:
        ModelError: If it does not stand.
        UsageError: If a setting asks for what the robot cannot do.
    """
    lacks, changed = list(overlaps(robot)), changes(robot, scenario)
    robot, said = _with_servos(robot)
    lacks += said
    world, kinematics = build(robot, scenario), Kinematics(robot)
    angle = lift_angle(kinematics, scenario.lift_height)
    check_standing(kinematics, load_world(world), angle)
    described, found = None, None
    try:
        described = equations(robot, scenario.fields)
    except ModelError as refusal:
        lacks.append(str(refusal))
    if described is not None:
        found = mobility_of(robot, described)
        lacks += immobile(robot, found)
    return Inspected(
        robot=robot,
        kinematics=kinematics,
        lift_angle=angle,
        let_down=world.let_down,
        equations=described,
        mobility=found,
        changed=changed,
        lacks=tuple(lacks),
    )


def _with_servos(robot: Robot) -> tuple[Robot, list[str]]:
    """The robot, given servos where its card has none, and what to say of that."""
    without = joints_without_servo(robot)
    if not without or robot.card.servo is not None:
        return robot, []
    servo = servo_for(robot)
    settings = ", ".join(f"{key} = {x:.4g}" for key, x in servo.settings.items())
    names = ", ".join(map(repr, without[:3])) + (", ..." if without[3:] else "")
    said = (
        f"servos: joints {names} have no position servo, and the card gives none; "
        f"write [servo] with {settings}, with which it stands"
    )
    return replace(robot, card=replace(robot.card, servo=servo)), [said]
