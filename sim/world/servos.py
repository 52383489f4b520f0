"""Position servos of the leg joints: what a scenario asks for, and the model's.

Motors and all other actuators that move a leg joint give way to its servo, and
equations that couple leg joints no longer hold. A servo behind a gear is replaced by
the same servo on the joint itself, so that commands are angles.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Literal

import mujoco
import numpy as np

from models import Card, ModelError, Robot, ServoKind
from models.description import (
    KNOWN_SERVOS,
    ON_JOINT,
    actuators_of,
    board_rate,
    is_position_servo,
    servo_of,
)
from planner.support import did_you_mean
from sim.errors import UsageError, message
from sim.scenarios.scenario import Scenario
from sim.world.others import couplings, other_drives

SOFT_STIFFNESS = 300.0  # [N m/rad]; docs/fidelity.md has the errors of softer servos


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoSettings:
    """Servos as they are simulated; None leaves a number to the robot's file."""

    name: str  # `ideal`, or the make
    stiffness: float | None  # torque an error [N m/rad]
    damping: float | None  # torque a speed [N m s/rad]
    damping_ratio: float | None = None  # to the critical one, where no damping is given
    torque: float | None = None  # largest [N m]; None for no limit but the file's
    speed: float | None = None  # at which no torque is left [rad/s]
    rate: float  # commands a second; 0 for one a physics step
    resolution: float  # angle of a count [rad]; 0 for none
    armature: float | None = None  # of the motor, where a file has none
    kind: ServoKind | None = None  # the make, or what a data sheet gives, unless ideal
    # Whether to make up for loads, rehearsed or predicted; None by the stiffness.
    feed_forward: bool | Literal["predicted"] | None

    def feeds_forward(self, stiffness: float) -> bool:
        """Whether commands make up for loads, on servos of a stiffness [N m/rad]."""
        soft, asked = stiffness < SOFT_STIFFNESS, self.feed_forward
        return soft if asked is None else bool(asked)

    def table(self, simulated: tuple[float, float] | None) -> dict[str, object]:
        """As summary.json has it."""
        table = asdict(self)
        for key in ("damping_ratio", "armature", "kind"):  # what they came to is there
            del table[key]
        if simulated is not None:
            table["stiffness"], table["damping"] = simulated
        return table


def servo_settings(scenario: Scenario, card: Card) -> ServoSettings:
    """The servos that a scenario asks for; its numbers win over those of the make."""
    fastest = 1 / scenario.timestep  # a command a physics step
    own = card.servo.made if card.servo is not None else ""
    name = scenario.servo or ("own" if own else "ideal")
    make = own if name == "own" else name
    asked = ServoSettings(
        name=make,
        stiffness=scenario.servo_stiffness,
        damping=scenario.servo_damping,
        rate=min(scenario.command_rate or 0.0, fastest),
        resolution=scenario.resolution or 0.0,
        feed_forward=scenario.feed_forward,
    )
    if name == "ideal" and (data := scenario.servo_data):
        raise UsageError.of("ideal_data", f"scenario {scenario.name!r}", data=data)
    if name == "ideal":
        return asked
    data = card.servo.data if card.servo is not None and make == own else {}
    kind = _kind(make, {**data, **(scenario.servo_data or {})}, scenario)
    if scenario.command_rate is not None:
        kind = kind.at_rate(asked.rate)
    elif kind.signal == "pulse":
        kind = kind.at_rate(board_rate(kind.command_rate, card.board_clock))
    return replace(
        asked,
        stiffness=kind.stiffness if asked.stiffness is None else asked.stiffness,
        damping_ratio=1.0 if asked.damping is None else None,
        torque=kind.stall_torque,
        speed=kind.no_load_speed,
        rate=min(kind.command_rate, fastest),
        resolution=kind.resolution if scenario.resolution is None else asked.resolution,
        armature=kind.rotor,
        kind=kind,
    )


def _kind(name: str, data: Mapping[str, float], scenario: Scenario) -> ServoKind:
    where = f"scenario {scenario.name!r}"
    if not name:
        raise UsageError.of("no_own_make", where)
    if name not in KNOWN_SERVOS:
        remedy = did_you_mean(name, ("ideal", "own", *KNOWN_SERVOS))
        raise UsageError(f"servo = {name!r} is unknown", where, remedy)
    try:
        return servo_of(name, data)
    except ValueError as error:
        raise UsageError.at(f"servo_data of {name!r}, {where}", error) from error


def ensure_servos(spec: mujoco.MjSpec, robot: Robot, asked: ServoSettings) -> None:
    """Leave one position servo on every leg joint, tuned as the scenario asks."""
    others = set(other_drives(robot))
    for actuator in [a for a in spec.actuators if a.name in others]:
        _remove(spec, actuator)
    for number in couplings(robot):
        spec.equalities[number].active = False
    for joint in robot.card.joints:
        servo = _only_servo(spec, spec.joint(joint)) or _add_servo(spec, robot, joint)
        if asked.damping is None and asked.damping_ratio is None:  # that of its gears
            spec.joint(joint).damping += servo.damping * servo.gear[0] ** 2
        servo.damping = np.zeros(3)
        servo.dyntype, servo.actlimited = mujoco.mjtDyn.mjDYN_NONE, 0
        servo.actrange, servo.actearly, servo.biasprm[0] = (0, 0), 0, 0.0
        servo.delay, servo.nsample, servo.interp = 0.0, 0, 0
        if servo.gear[0] != 1:
            _gear_down(servo)
        _tune(servo, asked)


def position_servos(spec: mujoco.MjSpec) -> list[mujoco.MjsActuator]:
    """Position servos on joints; a plugin has a law of its own."""
    plain = [a for a in spec.actuators if not a.plugin.active]
    on_joints = [a for a in plain if a.trntype in ON_JOINT]
    return [a for a in on_joints if is_position_servo(a.gainprm, a.biasprm, a.biastype)]


def _only_servo(
    spec: mujoco.MjSpec, joint: mujoco.MjsJoint
) -> mujoco.MjsActuator | None:
    """The joint's position servo; of its other actuators the rotors alone remain."""
    on_joints = [a for a in spec.actuators if a.trntype in ON_JOINT]
    servo = next((s for s in position_servos(spec) if s.target == joint.name), None)
    kept = servo.name if servo is not None else None
    for actuator in on_joints:
        if actuator.target == joint.name and actuator.name != kept:
            joint.armature += actuator.armature * actuator.gear[0] ** 2
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
        raise ModelError(message("no_position_servo", joint=joint, path=robot.path))
    on = mujoco.mjtTrn.mjTRN_JOINT
    actuator = spec.add_actuator(name=joint, target=joint, trntype=on)
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


@dataclass(frozen=True)
class Channels:
    """Commands of a model: the places of its leg joints in ctrl.

    What a joint has beside its servo are springs of its dead band, which follow it.
    """

    robot: Robot
    model: mujoco.MjModel

    def ctrl(self, targets: Mapping[str, np.ndarray]) -> np.ndarray:
        """Commands (T, nu) for angles (T,) of joints; others keep the keyframe's."""
        model, items = self.model, targets.items()
        columns = {a: angle for j, angle in items for a in actuators_of(model, j)}
        rows = np.tile(model.key("start").ctrl, (len([*columns.values()][0]), 1))
        rows[:, [*columns]] = np.stack([*columns.values()], axis=1)
        return np.ascontiguousarray(rows)

    def swing(self, qpos: np.ndarray) -> np.ndarray:
        """Actual angles of the groups in states (T, nq), shape (T, G) [rad].

        A group's angle is the mean of its legs'; servos lag behind their commands.
        """
        robot, joints = self.robot, self.robot.swing_joints
        places = [int(self.model.joint(joint).qposadr[0]) for joint in joints]
        standing = np.array([robot.standing_angle(joint) for joint in joints])
        legs = (qpos[:, places] - standing) / robot.swing_gain  # (T, F)
        groups = [robot.group_of_leg == g for g in range(len(robot.groups))]
        return np.stack([legs[:, own].mean(axis=1) for own in groups], axis=1)
