"""Imperfections of robot and floor: payload, slope, soft floor, friction, backlash.

The predictions know nothing of them; the comparison with the physics shows their
effect. Dead bands of servos are added by `dead_bands`.
"""

from collections.abc import Sequence
from math import atan, cos, radians, sin, tan
from typing import Any

import mujoco
import numpy as np

from models import Robot
from models.description import compile_model
from planner import Array
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario
from sim.world.parts import copy_settings

PAYLOAD = "payload"
BACKLASH = "backlash_"  # before the name of the joint whose gears have it
LOOSE = 1e-6  # [kg m^2]; inertia of what moves within the backlash
RUBBED = 1e-3  # [N m s/rad]; damping of it
ANGLES = ("range", "ref", "springref", "springyield")  # of a joint, in its file's unit
# Stops as MuJoCo has them by default give way like a spring of 0.6 N m/rad behind a leg
# as light as ours; these like one of some 5,000. Ten times harder ones rattle while the
# robot stands, and the solver takes three times as many iterations.
STOP = (0.002, 1.0)  # solref: time [s] and damping ratio
HARD = (0.999, 0.999, 0.001, 0.5, 2.0)  # solimp


def add_imperfections(
    spec: mujoco.MjSpec, robot: Robot, floor: str, scenario: Scenario
) -> None:
    """Add those that a scenario asks for."""
    _require_counts(robot, scenario)
    if scenario.floor_stiffness is not None:
        # A softer floor is damped less, in proportion. The damping of a stiffer one
        # stays, since the engine stops sliding feet by it: more would be unstable at
        # the timesteps of walks.
        stiffness, geom = scenario.floor_stiffness, spec.geom(floor)
        before, damping = geom.solref
        geom.solref = [-stiffness, damping * min(stiffness / -before, 1.0)]
    if slack := scenario.backlash:
        rigid = _mobility(spec, robot)
        own = {"solimp_limit": HARD, "armature": LOOSE, "damping": RUBBED}
        for name in robot.card.joints:
            add_loose(spec, name, BACKLASH, slack, **own)
        _stiffen(spec.geom(floor), _mobility(spec, robot) / rigid)
    if scenario.payload is not None and scenario.payload[0]:
        _add_payload(spec, robot, *scenario.payload)
    if scenario.slope is not None:
        _require_hold(scenario)
        angle, direction = scenario.slope  # what pulls down leans, not the plane z = 0
        downhill = sin(angle) * cos(direction), sin(angle) * sin(direction)
        size = float(np.linalg.norm(spec.option.gravity))
        spec.option.gravity = [size * part for part in (*downhill, -cos(angle))]
    if scenario.foot_friction is not None:
        _set_foot_friction(spec, robot, spec.geom(floor), scenario.foot_friction)


def _add_payload(spec: mujoco.MjSpec, robot: Robot, mass: float, *place: float) -> None:
    """Add a sphere that weighs this, whatever has mass in a file (but `boundmass`)."""
    compiler, size = spec.compiler, 0.005
    if (total := compiler.settotalmass) > 0:  # the engine scales all masses to this sum
        compiler.settotalmass = -1
        unscaled = compile_model(spec.copy(), str(robot.path)).body_mass.sum()
        compiler.settotalmass, mass = total + mass, mass * unscaled / total
    body = spec.body(robot.root).add_body(name=PAYLOAD, pos=place)
    if compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE:
        body.inertia, body.ipos = [0.4 * mass * size**2] * 3, [0, 0, 0]
        body.mass, body.explicitinertial = mass, True
    ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [size, 0, 0], "mass": mass}
    apart = {"group": compiler.inertiagrouprange[0], "contype": 0, "conaffinity": 0}
    body.add_geom(spec.default, name=PAYLOAD, **ball, **apart)


def _require_counts(robot: Robot, scenario: Scenario) -> None:
    joints = len(robot.card.joints), "joints", "joint, leg by leg, swing before lift"
    feet = len(robot.legs), "feet", "leg, in the order of their numbers"
    of_joints = dict.fromkeys(("zero_offset", "dead_band", "assumed_dead_band"), joints)
    for name, (number, what, order) in {**of_joints, "foot_friction": feet}.items():
        given = getattr(scenario, name)
        if isinstance(given, tuple) and len(given) != number:
            wrong = f"there are {number} {what}, and {name} lists {len(given)}"
            where, remedy = f"scenario {scenario.name!r}", f"give one for each {order}"
            raise UsageError(wrong, where, remedy)


def _require_hold(scenario: Scenario) -> None:
    """Refuse a floor too steep even for the feet that rub most, if they bear all."""
    angle, _ = scenario.slope or (0.0, 0.0)
    friction = max(scenario.foot_friction or (scenario.friction,))
    if angle and tan(angle) >= friction:
        facts = {"angle": angle, "friction": friction, "most": atan(friction)}
        where = f"scenario {scenario.name!r}"
        raise UsageError.of("steep", where, least=tan(angle), **facts)


def _stiffen(floor: mujoco.MjsGeom, ratio: float) -> None:
    """Make the floor give way to loose legs as far as to rigid ones.

    The engine divides stiffness and damping of a contact by its impedance d, and
    multiplies by d / (1 - d) over the mobility, which grows by the ratio.
    """
    impedance = floor.solimp[0]
    odds = ratio * impedance / (1 - impedance)
    higher = odds / (1 + odds)
    floor.solimp[:2] = higher
    floor.solref = [higher / impedance * number for number in floor.solref]


def _mobility(spec: mujoco.MjSpec, robot: Robot) -> float:
    """How easily a force moves a foot, as the engine takes it, on average [1/kg]."""
    model = compile_model(spec.copy(), str(robot.path))
    bodies = [int(model.geom(name).bodyid[0]) for name in robot.card.feet]
    return float(model.body_invweight0[bodies, 0].mean())


def _set_foot_friction(
    spec: mujoco.MjSpec, robot: Robot, floor: mujoco.MjsGeom, values: tuple[float, ...]
) -> None:
    """Friction of each foot, which then counts instead of the floor's.

    All that a contact has is taken from one geom, so feet get the floor's stiffness.
    """
    for leg, value in zip(robot.legs, values, strict=True):
        for name in robot.card.legs[leg].foot:
            foot = spec.geom(name)
            foot.friction = (value, *floor.friction[1:])
            foot.solref, foot.solimp = floor.solref, floor.solimp
            foot.condim, foot.priority = floor.condim, floor.priority + 1


def add_loose(
    spec: mujoco.MjSpec, name: str, prefix: str, width: float, **own: Any
) -> None:
    """Another joint about the axis of a joint, between stops a width apart [rad]."""
    joint = spec.joint(name)
    names = [other.name for other in joint.parent.joints]
    own |= {"type": mujoco.mjtJoint.mjJNT_HINGE, "pos": joint.pos, "axis": joint.axis}
    own |= {"name": prefix + name, "limited": True, "solref_limit": STOP}
    loose = _joint(spec, joint, **own)
    loose.range = np.array([-0.5, 0.5]) * width / _unit(loose)
    for later in names[names.index(name) + 1 :]:  # whose axes the loose joint turns too
        old = spec.joint(later)
        copy_settings(new := _joint(spec, old), old)
        for field in ANGLES * (old.type != mujoco.mjtJoint.mjJNT_SLIDE):
            scaled = np.multiply(_unit(old) / _unit(new), getattr(old, field))
            setattr(new, field, scaled)
        spec.delete(old)
        new.name = later


def _joint(spec: mujoco.MjSpec, like: mujoco.MjsJoint, **own: Any) -> mujoco.MjsJoint:
    """A new joint in the body and frame of another one, the last of that body."""
    added = like.parent.add_joint(spec.default, **own)  # not the default of the body
    if like.frame:
        added.set_frame(like.frame)
    return added


def _unit(joint: mujoco.MjsJoint) -> float:
    """The unit of a joint's angles, as its file has them [rad]."""
    return radians(1) if joint.compiler.degree else 1.0


def turned(
    model: mujoco.MjModel, qpos: Array, joints: Sequence[str], *parts: str
) -> Array:
    """Angles (T, J) of joints, and of those named by a part and them, in sum."""
    there = {model.joint(j).name: int(model.jnt_qposadr[j]) for j in range(model.njnt)}
    named = ([part + joint for part in ("", *parts)] for joint in joints)
    places = ([there[name] for name in names if name in there] for names in named)
    return np.stack([qpos[:, place].sum(axis=1) for place in places], axis=1)
