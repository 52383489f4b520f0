"""What the testbed changes in a robot's own file before it walks, in words."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import mujoco
import numpy as np

from models import Robot
from models.description import ON_JOINT
from sim.scenarios.scenario import Scenario
from sim.world.motors import added_rotors, undamped_joints
from sim.world.servos import (
    couplings,
    delayed_servos,
    joints_without_servo,
    other_drives,
    servo_settings,
)


def changes(robot: Robot, scenario: Scenario) -> Iterator[str]:
    """One sentence for each change."""
    spec = robot.read()
    if others := other_drives(robot):
        yield (
            f"actuators {_listed(others)} move leg joints by tendons, sites or bodies; "
            "they are left out, since every leg joint has a servo"
        )
    if bound := couplings(robot):
        names = [robot.model.eq(n).name or f"number {n + 1}" for n in bound]
        yield (
            f"equations {_listed(names)} couple leg joints; they are switched off, "
            "since every leg joint has a servo"
        )
    motors = {a.target for a in spec.actuators if a.trntype in ON_JOINT}
    if replaced := [j for j in joints_without_servo(robot) if j in motors]:
        yield f"servos replace the motors of joints {_listed(replaced)}"
    if late := delayed_servos(robot):
        yield (
            f"servos of joints {_listed(late)} follow commands through a filter and "
            "lag behind the others; it is left out"
        )
    asked = servo_settings(scenario, robot.card)
    if added := added_rotors(robot, asked):
        inertia = f"{next(iter(added.values())):.2g}"
        yield (
            f"joints {_listed([*added])} have no armature and would chatter; they "
            f"get that of a motor behind its gears, {inertia} kg m^2; to set another "
            'whatever the make, write armature="..." into the file'
        )
    if springs := undamped_joints(robot, asked):
        yield (
            f"the servos of joints {_listed([*springs])} have no damping, or little "
            "for a motor; they are critically damped; servo_damping sets another"
        )
    feet = [spec.geom(name) for name in robot.card.feet]
    if wide := [foot.name for foot in feet if foot.margin or foot.gap]:
        yield (
            f"feet {_listed(wide)} have a contact margin, which would push them off "
            "the floor before they touch; it is set to 0"
        )
    own = sorted({float(foot.friction[0]) for foot in feet} - {scenario.friction, 1.0})
    if own and scenario.foot_friction is None:
        yield (
            f"the friction of its feet, {', '.join(f'{mu:g}' for mu in own)}, gives "
            f"way to friction = {scenario.friction:g} of the scenario; set friction "
            "or foot_friction to keep it"
        )


def overlaps(robot: Robot) -> Iterator[str]:
    """Soles of different legs that are inside one another, contact or not."""
    model = robot.model
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_kinematics(model, data)
    soles = [(n, g) for n, leg in robot.card.legs.items() for g in leg.foot]
    for (leg, one), (other, two) in combinations(soles, 2):
        if leg == other:
            continue
        pair = model.geom(one).id, model.geom(two).id
        if (apart := mujoco.mj_geomDistance(model, data, *pair, 0.0, np.zeros(6))) < 0:
            yield (
                f"feet {one!r} and {two!r} overlap by {-1e3 * apart:.1f} mm where it "
                "stands; make them smaller, or mount the legs farther apart"
            )


def _listed(names: list[str]) -> str:
    return ", ".join(map(repr, names[:3])) + (", ..." if names[3:] else "")
