"""Position servos of the leg joints: the robot's own, or those of its card.

Motors and all other actuators that move a leg joint give way to its servo, and
equations that couple leg joints no longer hold. A servo behind a gear is replaced by
the same servo on the joint itself, so that commands are angles.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from models import ModelError, Robot
from models.description import ON_JOINT, actuator_of, is_position_servo
from sim.world.servo_settings import ServoSettings

COUPLING = (int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON))
MOVES = 1e-9  # moment of an actuator about a joint, below which it does not move it
INHERITED = (
    "gear", "ctrllimited", "forcelimited", "actlimited", "ctrlrange", "forcerange",
    "actrange", "lengthrange", "inheritrange", "dyntype", "dynprm", "gaintype",
    "gainprm", "biastype", "biasprm", "cranklength", "armature", "damping",
)  # fmt: skip
"""What an actuator takes from the defaults of the file that it is added to."""


def ensure_servos(spec: mujoco.MjSpec, robot: Robot, asked: ServoSettings) -> None:
    """Leave one position servo on every leg joint, tuned as the scenario asks."""
    others = set(other_drives(robot))
    for actuator in [a for a in spec.actuators if a.name in others]:
        _remove(spec, actuator)
    for number in couplings(robot):
        spec.equalities[number].active = False
    for joint in robot.card.joints:
        servo = _only_servo(spec, joint) or _add_servo(spec, robot, joint)
        servo.dyntype = mujoco.mjtDyn.mjDYN_NONE
        if servo.gear[0] != 1:
            _gear_down(servo)
        _tune(servo, asked)


def delayed_servos(robot: Robot) -> list[str]:
    """Leg joints of a robot whose position servos follow commands with a delay."""
    servos = [s for s in _servos(robot.read()) if s.target in robot.card.joints]
    return [s.target for s in servos if s.dyntype != mujoco.mjtDyn.mjDYN_NONE]


def joints_without_servo(robot: Robot) -> list[str]:
    """Leg joints of a robot that its file gives no position servo."""
    served = {servo.target for servo in _servos(robot.read())}
    return [joint for joint in robot.card.joints if joint not in served]


def _servos(spec: mujoco.MjSpec) -> list[mujoco.MjsActuator]:
    """Position servos on joints."""
    on_joints = [a for a in spec.actuators if a.trntype in ON_JOINT]
    return [a for a in on_joints if is_position_servo(a.gainprm[0], a.biasprm[1])]


def _only_servo(spec: mujoco.MjSpec, joint: str) -> mujoco.MjsActuator | None:
    """The joint's position servo, after its other actuators have been taken off."""
    servo = next((s for s in _servos(spec) if s.target == joint), None)
    kept = servo.name if servo is not None else None
    driving = [a for a in spec.actuators if a.trntype in ON_JOINT and a.target == joint]
    for actuator in driving:
        if actuator.name != kept:
            _remove(spec, actuator)
    return servo


def _remove(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator) -> None:
    """Delete an actuator, and the sensors that watch it."""
    for sensor in list(spec.sensors):
        watched = (sensor.objtype, sensor.objname)
        if watched == (mujoco.mjtObj.mjOBJ_ACTUATOR, actuator.name):
            spec.delete(sensor)
    spec.delete(actuator)


def _add_servo(spec: mujoco.MjSpec, robot: Robot, joint: str) -> mujoco.MjsActuator:
    servo = robot.card.servo
    if servo is None:
        raise ModelError(
            f"joint {joint!r} has no position servo: {robot.path}; "
            "give stiffness and damping under [servo] in the card"
        )
    on = mujoco.mjtTrn.mjTRN_JOINT
    actuator = spec.add_actuator(name=joint, target=joint, trntype=on)
    plain = mujoco.MjSpec().add_actuator()
    for setting in INHERITED:  # the file's defaults are for its own actuators
        setattr(actuator, setting, getattr(plain, setting))
    actuator.set_to_position(kp=servo.stiffness, kv=servo.damping)
    actuator.armature = servo.armature
    return actuator


def _gear_down(servo: mujoco.MjsActuator) -> None:
    """Replace a servo behind a gear by its equal on the joint itself."""
    gear, servo.gear[0] = servo.gear[0], 1
    servo.gainprm[0] *= gear**2
    servo.biasprm[1] *= gear**2
    if servo.biasprm[2] < 0:  # otherwise it is a damping ratio, which no gear changes
        servo.biasprm[2] *= gear**2
    servo.armature *= gear**2
    servo.ctrlrange = sorted(servo.ctrlrange / gear)
    servo.forcerange = sorted(servo.forcerange * gear)


def _tune(servo: mujoco.MjsActuator, asked: ServoSettings) -> None:
    """Set stiffness, damping and largest torque; what is not given stays."""
    if asked.stiffness is not None:
        servo.gainprm[0], servo.biasprm[1] = asked.stiffness, -asked.stiffness
    if asked.damping is not None:
        servo.biasprm[2] = -asked.damping
    if asked.damping_ratio is not None:
        servo.biasprm[2] = asked.damping_ratio  # its sign sets it apart from a damping
    if asked.torque is not None:
        servo.forcelimited = True
        servo.forcerange = (-asked.torque, asked.torque)


def common_servo(model: mujoco.MjModel, robot: Robot) -> tuple[float, float] | None:
    """Stiffness and damping of all leg joints' servos, None if they differ."""
    driving = [actuator_of(model, joint) for joint in robot.card.joints]
    gains = model.actuator_gainprm[driving, 0], -model.actuator_biasprm[driving, 2]
    found = set(zip(*(gain.tolist() for gain in gains), strict=True))
    return found.pop() if len(found) == 1 else None


def other_drives(robot: Robot) -> list[str]:
    """Names of the actuators that move leg joints from elsewhere than the joint itself.

    Those that are on legs of the card are found by their moments about the leg joints,
    where the robot starts.
    """
    model = robot.model
    data, dofs = _at_start(model, robot)
    found = []
    for actuator in np.flatnonzero(~np.isin(model.actuator_trntype, ON_JOINT)):
        first = data.moment_rowadr[actuator]
        row = slice(first, first + data.moment_rownnz[actuator])
        moves = np.abs(data.actuator_moment[row]) > MOVES
        if dofs & set(data.moment_colind[row][moves].tolist()):
            found.append(model.actuator(int(actuator)).name)
    return found


def couplings(robot: Robot) -> list[int]:
    """Equations of the file that tie leg joints to others, directly or by tendons."""
    model = copy(robot.model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data, dofs = _at_start(model, robot)
    moved = (np.abs(data.efc_J.reshape(-1, model.nv)) > MOVES)[:, sorted(dofs)]
    equal = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    numbers = np.unique(data.efc_id[equal & moved.any(axis=1)])
    return numbers[np.isin(model.eq_type[numbers], COUPLING)].tolist()


def _at_start(model: mujoco.MjModel, robot: Robot) -> tuple[mujoco.MjData, set[int]]:
    """The model where the robot starts, and the dofs of its leg joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_forward(model, data)
    return data, {int(model.joint(joint).dofadr[0]) for joint in robot.card.joints}


@dataclass(frozen=True)
class Channels:
    """Commands of a model: the places of its leg joints in ctrl."""

    robot: Robot
    model: mujoco.MjModel

    def ctrl(self, targets: Mapping[str, np.ndarray]) -> np.ndarray:
        """Commands (T, nu) for angles of joints, by their names, (T,) each [rad].

        Actuators of other joints keep the keyframe's value.
        """
        columns = {actuator_of(self.model, j): angle for j, angle in targets.items()}
        rows = np.tile(self.model.key("start").ctrl, (len([*columns.values()][0]), 1))
        for column, angle in columns.items():
            rows[:, column] = angle
        return np.ascontiguousarray(rows)

    def swing(self, qpos: np.ndarray) -> np.ndarray:
        """Actual angles of the groups in states (T, nq), shape (T, G) [rad].

        A group's angle is the mean of its legs'; servos lag behind their commands.
        """
        robot, joints = self.robot, self.robot.swing_joints
        places = [int(self.model.joint(joint).qposadr[0]) for joint in joints]
        standing = np.array([robot.standing_angle(joint) for joint in joints])
        legs = (qpos[:, places] - standing) / robot.swing_gain  # (T, F)
        groups = range(len(robot.groups))
        means = [legs[:, robot.group_of_leg == g].mean(axis=1) for g in groups]
        return np.stack(means, axis=1)
