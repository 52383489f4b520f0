"""A robot as it can be looked at, whether or not it can walk everywhere, in numbers.

What it lacks for walking is put into words. A robot that cannot even stand is refused.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

import models
from models.adoption import servo_for
from models.contact import lift_torques
from models.description import actuators_driving
from sim.errors import message
from sim.motion.stability import margin_at_rest
from sim.physics.standing import check_standing
from sim.preparation.reach import immobile, lift_angle
from sim.scenarios.scenario import Scenario, drawn
from sim.world.changes import changes, overlaps
from sim.world.model import World, build, load as load_world
from sim.world.servos import SOFT_STIFFNESS, position_servos, servo_settings

Facts = dict[str, Any]


def inspected(scenario: Scenario, robot: models.Robot) -> Facts:
    """Mass, legs, groups, fields and margins of a robot.

    What keeps it from walking is listed, not refused. A robot that does not stand, or
    cannot do what a setting asks for, is refused.
    """
    scenario = drawn(scenario, robot)
    lacks, changed = list(overlaps(robot)), tuple(changes(robot, scenario))
    robot, missing = _with_servos(robot)
    lacks += missing
    world, kinematics = build(robot, scenario), models.Kinematics(robot)
    angle = lift_angle(kinematics, scenario.lift_height)
    check_standing(kinematics, load_world(world), angle)
    described, found = None, None
    try:
        described = models.equations(robot, scenario.fields)
    except models.ModelError as refusal:
        lacks.append(str(refusal))
    if described is not None:
        found = models.mobility_of(robot, described)
        lacks += immobile(robot, found)
    return _facts(scenario, kinematics, angle, world, described, found, changed, lacks)


def _servos(scenario: Scenario, kinematics: models.Kinematics, world: World) -> Facts:
    """Servos as they are simulated, and the torque that walking asks of them [N m].

    It is that of the joint that bears most, at rest and with feet that slide. All walks
    are within that of `makes`; `some` have what standing takes. The weakest are first.
    """
    robot = kinematics.robot
    asked, strata = servo_settings(scenario, robot.card), robot.card.strata
    standing, sliding = (
        np.array([lift_torques(kinematics, s, friction) for s in strata])
        for friction in (0.0, scenario.friction)
    )
    stratum, leg = np.unravel_index(sliding.round(6).argmax(), sliding.shape)
    least, most = float(standing[stratum, leg]), float(sliding.max())
    model = load_world(world)
    lifts = actuators_driving(model, robot.lift_joints)
    weakest = float(model.actuator_forcerange[lifts, 1].min())  # 0 without a limit
    drives = actuators_driving(model, robot.card.joints)
    softest = float(model.actuator_gainprm[drives, 0].min())
    own = asked.name == "ideal" and softest < SOFT_STIFFNESS  # of the robot's file
    makes = sorted((k.stall_torque, n) for n, k in models.SERVO_KINDS.items())
    return {
        "name": "own" if own else asked.name,
        "stiffness": softest,
        "torque": asked.torque or weakest or None,
        "joint": robot.lift_joints[leg],
        "stratum": strata[stratum],
        "standing": least,
        "sliding": most,
        "makes": [name for torque, name in makes if torque > most],
        "some": [name for torque, name in makes if least < torque <= most],
    }


def _with_servos(robot: models.Robot) -> tuple[models.Robot, list[str]]:
    """The robot, given servos where its card has none, and a sentence about that."""
    served = {servo.target for servo in position_servos(robot.read())}
    without = [joint for joint in robot.card.joints if joint not in served]
    if not without or robot.card.servo is not None:
        return robot, []
    servo = servo_for(robot)
    settings = ", ".join(f"{key} = {x:.4g}" for key, x in servo.settings.items())
    names = ", ".join(map(repr, without[:3])) + (", ..." if without[3:] else "")
    missing = message("no_servos", names=names, settings=settings)
    return replace(robot, card=replace(robot.card, servo=servo)), [missing]


def _facts(
    scenario: Scenario,
    kinematics: models.Kinematics,
    lift: float,
    world: World,
    described: models.Equations | None,
    found: models.Mobility | None,
    changed: Sequence[str],
    lacks: Sequence[str],
) -> Facts:
    """A robot that stands; without equations it has neither fields nor strokes."""
    robot, stance = kinematics.robot, kinematics.standing
    legs = zip(robot.legs, robot.leg_cards, stance.feet, strict=True)
    spans = robot.swing_range
    groups = [(name, of, spans[name]) for name, of in robot.card.groups.items()]
    return {
        "name": robot.name,
        "description": robot.card.description,
        "mass": float(robot.model.body_subtreemass[robot.model.body(robot.root).id]),
        "weight_height": float(kinematics.center_of_mass[2] - stance.height.min()),
        "lift": {
            "angle": lift,
            "height": float(kinematics.rise(np.array(lift)).min()),
            "highest": kinematics.highest,
        },
        "legs": {
            str(leg): {
                "foot": foot.tolist(),
                "swing": {"joint": card.swing, "range": list(robot.span(card.swing))},
                "lift": {"joint": card.lift, "range": list(robot.span(card.lift))},
                "held": dict(card.hold),
            }
            for leg, card, foot in legs
        },
        "groups": {
            name: {"legs": sorted(group.legs), "swing": [*map(float, ends)]}
            for name, group, ends in groups
        },
        "gait": list(robot.card.gait),
        "let_down": world.let_down,
        "servos": _servos(scenario, kinematics, world),
        "fields": {
            name: [float(rate) for rate in twist]
            for name, twist in (described.twists if described else {}).items()
            if any(twist)
        },
        "strokes": {
            cost.direction: cost.strokes
            for cost in (found.costs if found else ())
            if isfinite(cost.strokes)
        },
        "changed": list(changed),
        "lacks": list(lacks),
        "margins": {n: margin_at_rest(kinematics, n) for n in robot.card.strata},
    }
