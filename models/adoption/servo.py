"""Servos for joints that have none: stiff enough to bear the robot with little sag."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from models.adoption.anatomy import Pose
from models.contact.kinematics import Kinematics
from models.description.card import Servo
from models.description.compiled import actuators_of, is_position_servo
from models.description.robot import Robot

STIFF = 2500.0  # times the torque that a leg bears, for a radian
FASTEST = 700.0  # [rad/s] of a servo's own frequency, as that of the shipped robots


def servo_for(robot: Robot) -> Servo:
    """A servo that suits all leg joints of a robot.

    Args:
        robot: Robot whose card gives none.
    """
    kinematics = Kinematics(robot)
    feet = kinematics.standing.feet
    model = robot.model
    pose = Pose.at(model, model.body(robot.root).id, robot.start_qpos)
    legs = [robot.card.legs[leg] for leg in robot.legs]
    hips = np.array([pose.data.joint(leg.swing).xanchor[:2] for leg in legs])
    arm = float(np.linalg.norm(feet - hips, axis=1).max())
    joints = [joint for leg in legs for joint in leg.joints]
    return drafted_servo(pose, joints, arm, len(legs))


def drafted_servo(pose: Pose, joints: Sequence[str], arm: float, legs: int) -> Servo:
    """A servo for some joints, critically damped.

    Half of the legs are to bear the weight with little sag. A stiff servo has gears,
    and behind them its rotor weighs more than the leg does. Files of mere links, as
    URDF often are, leave that out, and on joints of so little inertia the physics step
    cannot follow a stiff servo: feet would bounce. Such joints get the rotor as well.

    Args:
        pose: The model as it stands.
        joints: Names of the joints.
        arm: Distance of a foot from its hip [m].
        legs: Number of legs.
    """
    model = pose.model
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_crb(model, pose.data)
    mujoco.mj_fullM(model, pose.data, inertia)
    own = np.diag(inertia)[[int(model.joint(name).dofadr[0]) for name in joints]]
    weight = 9.81 * float(model.body_subtreemass[pose.root])
    stiffness = STIFF * weight * arm / (legs / 2)
    armature = max(stiffness / FASTEST**2 - float(own.min()), 0.0)
    critical = 2 * float(np.sqrt(stiffness * (np.median(own) + armature)))
    return Servo(stiffness, critical, armature=armature)


def has_servo(model: mujoco.MjModel, joint: str) -> bool:
    """Whether a position servo drives a joint.

    Args:
        model: Model of the robot.
        joint: Name of the joint.
    """
    return servo_stiffness(model, joint) > 0


def servo_stiffness(model: mujoco.MjModel, joint: str) -> float:
    """Stiffness of the position servo that drives a joint, 0 if none does [N m/rad].

    Args:
        model: Model of the robot.
        joint: Name of the joint.
    """
    for actuator in actuators_of(model, joint):
        gain, bias = model.actuator_gainprm[actuator, 0], model.actuator_biasprm
        if is_position_servo(gain, bias[actuator, 1]):
            return float(gain * model.actuator_gear[actuator, 0] ** 2)
    return 0.0
