"""A robot as it can be looked at, whether or not it can walk everywhere, in numbers.

What it lacks for walking is put into words. A robot that cannot even stand is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

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
from sim.motion.prediction import margin_at_rest
from sim.physics.standing import check_standing
from sim.preparation.reach import immobile, lift_angle
from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario
from sim.world.changes import changes, overlaps
from sim.world.model import World, build, load as load_world
from sim.world.servos import joints_without_servo

Facts = dict[str, Any]
SHOWN_MOVE = 1e-3  # [m]; less of a move at the start is not shown


def facts_of(setup: Setup) -> Facts:
    """Mass, legs, groups, fields and margins of a robot that is set up to walk."""
    robot, described = setup.robot, setup.equations
    found, changed = mobility_of(robot, described), [*changes(robot, setup.scenario)]
    stands = setup.kinematics, setup.limits.lift_angle, setup.world
    return _facts(*stands, described, found, changed)


def inspected(scenario: Scenario, robot: Robot) -> Facts:
    """Look at a robot; what keeps it from walking is listed, not refused.

    A robot that does not stand, or cannot do what a setting asks for, is refused.
    """
    lacks, changed = list(overlaps(robot)), tuple(changes(robot, scenario))
    robot, missing = _with_servos(robot)
    lacks += missing
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
    return _facts(kinematics, angle, world, described, found, changed, lacks)


def _with_servos(robot: Robot) -> tuple[Robot, list[str]]:
    """The robot, given servos where its card has none, and a sentence about that."""
    without = joints_without_servo(robot)
    if not without or robot.card.servo is not None:
        return robot, []
    servo = servo_for(robot)
    settings = ", ".join(f"{key} = {x:.4g}" for key, x in servo.settings.items())
    names = ", ".join(map(repr, without[:3])) + (", ..." if without[3:] else "")
    missing = (
        f"servos: joints {names} have no position servo, and the card gives none; "
        f"write [servo] with {settings}, with which it stands"
    )
    return replace(robot, card=replace(robot.card, servo=servo)), [missing]


def _facts(
    kinematics: Kinematics,
    lift: float,
    world: World,
    described: Equations | None,
    found: Mobility | None,
    changed: Sequence[str],
    lacks: Sequence[str] = (),
) -> Facts:
    """A robot that stands; without equations it has neither fields nor strokes."""
    robot, lifting, stance = kinematics.robot, kinematics.lifting, kinematics.standing
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
            "height": float(lifting.rise(np.array(lift)).min()),
            "highest": lifting.highest,
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


def describe(robot: Facts) -> str:
    """The facts in lines for a terminal."""
    lift = robot["lift"]
    margins = (f"S{name} {1e3 * m:.1f} mm" for name, m in robot["margins"].items())
    down = robot["let_down"]
    how = "let down onto" if down > 0 else "lifted out of"
    moved = f"{'start':12}{how} the floor by {1e3 * abs(down):.1f} mm"
    lines = [
        f"{robot['name']}: {robot['description']}".rstrip(": "),
        f"{'weight':12}{robot['mass']:.3f} kg, centre of mass "
        f"{1e3 * robot['weight_height']:.1f} mm above the floor",
        f"{'lift':12}{lift['angle']:.4g} rad raise the feet by "
        f"{1e3 * lift['height']:.1f} mm; at most {1e3 * lift['highest']:.1f} mm",
        *([moved] if abs(down) >= SHOWN_MOVE else []),
        f"{'gait':12}{' '.join(robot['gait'])}, the groups of legs that stand in turn",
        f"{'margins':12}{', '.join(margins)}, of the centre of mass inside these feet",
        "",
        f"{'leg':6}{'foot at x, y [m]':22}{'swing joint [rad]':34}lift joint [rad]",
    ]
    lines += [_leg_line(number, leg) for number, leg in robot["legs"].items()]
    lines += ["", f"{'group':6}{'swings [rad]':22}legs"]
    for name, group in robot["groups"].items():
        legs = " ".join(map(str, group["legs"]))
        lines.append(f"{name:6}{_range(group['swing']):22}{legs}")
    if robot["fields"]:
        first = next(iter(robot["fields"]))
        named = "input {2} on S{0}".format(*first[1:].partition("_"))
        head = f"{'field':18}forward, left [m/rad], yaw [rad/rad]"
        lines += ["", f"{head}; {first} is {named}"]
    for name, (forward, left, yaw) in robot["fields"].items():
        lines.append(f"{name:18}{forward:z8.4f}{left:z9.4f}{yaw:z9.4f}")
    units = {"theta": "radian"}
    if costs := [
        f"{n:.3g} for a {units.get(name, 'metre')} of {name}"
        for name, n in robot["strokes"].items()
    ]:
        each = "each over a joint's whole range, recoveries included"
        lines += ["", f"{'strokes':12}{', '.join(costs)}; {each}"]
    for heading in ("changed", "lacks"):
        for k, sentence in enumerate(robot[heading]):
            lines.append(f"{'' if k else heading:12}{sentence}")
    return "\n".join(lines)


def _leg_line(number: str, leg: Facts) -> str:
    x, y = leg["foot"]
    pair = leg["swing"], leg["lift"]
    swing, lift = (f"{of['joint']} {_range(of['range'])}" for of in pair)
    held = "".join(f", {joint} held at {a:g}" for joint, a in leg["held"].items())
    return f"{number:6}{f'{x:7.4f} {y:8.4f}':22}{swing:34}{lift}{held}"


def _range(span: list[float]) -> str:
    return f"{span[0]:.3g} to {span[1]:.3g}"
