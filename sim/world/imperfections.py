"""Imperfections of robot and floor: payload, slope, soft floor, friction, backlash.

The predictions know nothing of them; the comparison with the physics shows their
effect. A servo with a dead band is a spring behind backlash as wide: neither gives a
torque within it, and beyond it both give the stiffness times the rest of the error.
"""

from __future__ import annotations

from math import cos, sin

import mujoco
import numpy as np

from models import Robot
from models.description import compile_model
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario

PAYLOAD = "payload"
BACKLASH = "backlash_"  # before the name of the joint whose gears have it
LOOSE = 1e-6  # [kg m^2]; inertia of what moves within the backlash
RUBBED = 1e-3  # [N m s/rad]; damping of it
# Stops as MuJoCo has them by default give way like a spring of 0.6 N m/rad behind a leg
# as light as ours; these like one of some 5,000. Ten times harder ones rattle while the
# robot stands, and the solver takes three times as many iterations.
STOP = (0.002, 1.0)  # solref: time [s] and damping ratio
HARD = (0.999, 0.999, 0.001, 0.5, 2.0)  # solimp


def add_imperfections(
    spec: mujoco.MjSpec, robot: Robot, floor: str, scenario: Scenario
) -> None:
    """Add those that a scenario asks for."""
    _require_offsets(robot, scenario)
    if scenario.floor_stiffness is not None:
        _soften(spec.geom(floor), scenario.floor_stiffness)
    if slack := scenario.backlash + scenario.dead_band:
        rigid = _mobility(spec, robot)
        _loosen(spec, robot, slack)
        _stiffen(spec.geom(floor), _mobility(spec, robot) / rigid)
    if scenario.payload is not None:
        _load(spec.body(robot.root), *scenario.payload)
    if scenario.slope is not None:
        _tilt(spec, *scenario.slope)
    if scenario.foot_friction is not None:
        _set_foot_friction(spec, robot, spec.geom(floor), scenario)


def _require_offsets(robot: Robot, scenario: Scenario) -> None:
    given = scenario.zero_offset
    joints = len(robot.card.joints)
    if isinstance(given, tuple) and len(given) != joints:
        raise UsageError(
            f"zero_offset has {len(given)} values for {joints} joints",
            f"scenario {scenario.name!r}",
            "give one for each joint, leg by leg, swing before lift",
        )


def _load(root: mujoco.MjsBody, mass: float, x: float, y: float, z: float) -> None:
    """A small ball of the mass, which touches nothing, as a body of its own."""
    if mass:
        root.add_body(name=PAYLOAD, pos=[x, y, z]).add_geom(
            name=PAYLOAD,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[0.005, 0, 0],
            mass=mass,
            contype=0,
            conaffinity=0,
        )


def _tilt(spec: mujoco.MjSpec, angle: float, direction: float) -> None:
    """The floor stays the plane z = 0; what pulls down leans instead."""
    size = float(np.linalg.norm(spec.option.gravity))
    downhill = sin(angle) * cos(direction), sin(angle) * sin(direction)
    spec.option.gravity = [size * part for part in (*downhill, -cos(angle))]


def _soften(floor: mujoco.MjsGeom, stiffness: float) -> None:
    """Stiffness of the contact; a softer one is damped less, in proportion.

    The damping of a stiffer one stays, since the engine stops sliding feet by it: more
    would be unstable at the timesteps of walks.
    """
    before, damping = floor.solref
    floor.solref = [-stiffness, damping * min(stiffness / -before, 1.0)]


def _stiffen(floor: mujoco.MjsGeom, ratio: float) -> None:
    """Make the floor give way to loose legs as far as to rigid ones.

    The engine takes stiffness and damping of contacts as accelerations, and divides by
    an impedance d what it multiplies by d / (1 - d) over the mobility of what stands on
    the floor. Both the odds of d and the mobility grow by the ratio, so that forces
    stay the same.
    """
    impedance = floor.solimp[0]
    odds = ratio * impedance / (1 - impedance)
    higher = odds / (1 + odds)
    floor.solimp[:2] = higher
    floor.solref = [higher / impedance * number for number in floor.solref]


def _mobility(spec: mujoco.MjSpec, robot: Robot) -> float:
    """How easily a force moves a foot, as the engine takes it, on average [1/kg]."""
    model = compile_model(spec.copy(), str(robot.path))
    feet = [model.geom(name).id for name in robot.card.feet]
    bodies = model.geom_bodyid[feet]
    return float(model.body_invweight0[bodies, 0].mean())


def _set_foot_friction(
    spec: mujoco.MjSpec, robot: Robot, floor: mujoco.MjsGeom, scenario: Scenario
) -> None:
    """Friction of each foot, which then counts instead of the floor's.

    All that a contact has is taken from one geom, so feet get the floor's stiffness.
    """
    values = scenario.foot_friction or ()
    if len(values) != len(robot.legs):
        raise UsageError(
            f"foot_friction has {len(values)} values for {len(robot.legs)} feet",
            f"scenario {scenario.name!r}",
            "give one for each leg, in the order of their numbers",
        )
    for leg, value in zip(robot.legs, values, strict=True):
        for name in robot.card.legs[leg].foot:
            foot = spec.geom(name)
            foot.friction = (value, *floor.friction[1:])
            foot.solref, foot.solimp = floor.solref, floor.solimp
            foot.condim, foot.priority = floor.condim, floor.priority + 1


def _loosen(spec: mujoco.MjSpec, robot: Robot, backlash: float) -> None:
    """Behind every leg joint another one about its axis, free within the backlash."""
    for name in robot.card.joints:
        joint = spec.joint(name)
        joint.parent.add_joint(
            name=BACKLASH + name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            pos=joint.pos,
            axis=joint.axis,
            limited=True,
            range=[-backlash / 2, backlash / 2],
            armature=LOOSE,
            damping=RUBBED,
            solref_limit=STOP,
            solimp_limit=HARD,
        )
