"""What files of robots leave out of their motors: the rotor's inertia, and damping.

Behind its gears the rotor of a small motor is heavier than a hobby robot's leg, whose
foot would chatter on the stiff floor without it, as on a spring that nothing damps.
Joints without armature are therefore given that of the servo's make, or of a motor that
could carry the robot; servos without damping are critically damped.
"""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from models import Robot
from models.adoption import FASTEST, servo_for
from models.description import ON_JOINT, actuators_driving, position_servos_of
from sim.world.servos import ServoSettings

CRITICAL = 1.0  # damping ratio, which the engine tells by its sign from a damping
LIVELY = 0.5  # damping ratio below which a servo with a new rotor would swing for long
ANY = 1e-3  # damping ratio of a servo that is damped at all


def added_rotors(robot: Robot, asked: ServoSettings) -> Mapping[str, float]:
    """Reflected inertia that leg joints are given, by joint [kg m^2].

    Legs that weigh as much as a motor's rotor by themselves get none, unless the
    servo's make is known.
    """
    joints = robot.joints_without_rotor
    if not joints:
        return {}
    rotor = servo_for(robot).armature if asked.armature is None else asked.armature
    return dict.fromkeys(joints, rotor) if rotor else {}


def inertia_share(robot: Robot, model: mujoco.MjModel, joints: Sequence[str]) -> float:
    """Least inertia of some joints in a world, as a share of a fitting motor's."""
    dofs = [int(model.joint(joint).dofadr[0]) for joint in joints]
    rotor = servo_for(robot).stiffness / FASTEST**2  # of a motor that could carry it
    return float(model.dof_M0[dofs].min()) / rotor


def undamped_joints(robot: Robot, asked: ServoSettings) -> tuple[str, ...]:
    """Leg joints whose servos are damped too little; none if damping is asked for."""
    if asked.damping is not None or asked.damping_ratio is not None:
        return ()
    model, added = robot.model, added_rotors(robot, asked)

    def damping_ratio(joint: str, servo: int) -> float:
        dof = model.joint(joint).dofadr[0]
        inertia = model.dof_M0[dof] + added.get(joint, 0.0)
        gear = model.actuator_gear[servo, 0] ** 2
        own = model.actuator_damping[servo] - model.actuator_biasprm[servo, 2]
        critical = 2 * np.sqrt(gear * model.actuator_gainprm[servo, 0] * inertia)
        return float((gear * own + model.dof_damping[dof]) / critical)

    return tuple(
        joint
        for joint in robot.card.joints
        for servo in position_servos_of(robot.model, joint)[:1]
        if damping_ratio(joint, servo) < (LIVELY if joint in added else ANY)
    )


def ensure_motors(spec: mujoco.MjSpec, robot: Robot, asked: ServoSettings) -> None:
    """Give leg joints the armature, and their servos damping and limits, they lack."""
    for name, inertia in added_rotors(robot, asked).items():
        joint, own = spec.joint(name), robot.model.joint(name)
        joint.armature = inertia
        if any(joint.springdamper):  # which would grow with that inertia
            joint.stiffness[0], joint.damping[0] = own.stiffness[0], own.damping[0]
            joint.springdamper[:] = 0
    undamped = undamped_joints(robot, asked)
    for servo in spec.actuators:
        if servo.trntype in ON_JOINT and servo.target in undamped:
            servo.biasprm[2] = CRITICAL
        if servo.trntype in ON_JOINT and servo.target in robot.card.joints:
            _take_limit(servo, spec.joint(servo.target), asked)


def _take_limit(
    servo: mujoco.MjsActuator, joint: mujoco.MjsJoint, asked: ServoSettings
) -> None:
    """Move the torque that the file allows a joint, `effort` in URDF, to its servo.

    A make of servo has a torque of its own, whatever was on the joint before.
    """
    if not joint.actfrclimited or not any(joint.actfrcrange):
        return
    joint.actfrclimited = False
    if asked.torque is None:
        ranges = [joint.actfrcrange]
        if servo.forcelimited and any(servo.forcerange):
            ranges.append(servo.forcerange)
        low, high = np.array(ranges).T
        servo.forcerange, servo.forcelimited = (low.max(), high.min()), True


def common_servo(model: mujoco.MjModel, robot: Robot) -> tuple[float, float] | None:
    """Stiffness and damping of all leg joints' servos, None if they differ."""
    driving = actuators_driving(model, robot.card.joints)
    gains = model.actuator_gainprm[driving, 0], -model.actuator_biasprm[driving, 2]
    found = set(zip(*(gain.tolist() for gain in gains), strict=True))
    return found.pop() if len(found) == 1 else None
