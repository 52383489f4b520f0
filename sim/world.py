"""The model that a run simulates: a robot on the floor, with the run's settings.

Adds to the robot's file what measurement needs and is not there yet: floor, position
servos, sensors, keyframe `start`. The run simulates the model compiled from the text.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from models.errors import ModelError
from models.kinematics import Kinematics
from models.robot import FOLDER, Robot, actuator_of, compile_model
from sim.errors import UsageError
from sim.obstacles.walls import add_walls
from sim.scenario import Scenario

CONTACT_FIELDS = 10  # found 1, force 3, position 3, relative velocity 3
_SLOTS = {mujoco.mjtGeom.mjGEOM_SPHERE: 1, mujoco.mjtGeom.mjGEOM_CAPSULE: 2}


def build(robot: Robot, scenario: Scenario) -> str:
    """MJCF text of robot and world; self-contained, loads in bare MuJoCo.

    Args:
        robot: Robot to put on the floor.
        scenario: Settings of solver, friction and servos.

    Raises:
        ModelError: If a joint has no servo and the card gives none.
    """
    spec = robot.read()
    _set_options(spec, scenario.timestep)
    floor = _ensure_floor(spec)
    _set_friction(spec, robot, floor, scenario.friction)
    _ensure_servos(spec, robot, scenario)
    _ensure_sensors(spec, robot, floor)
    _ensure_start(spec, robot)
    add_walls(spec, robot.root, scenario.obstacles)
    compile_model(spec, str(robot.path))
    return str(spec.to_xml())


def load(text: str) -> mujoco.MjModel:
    """Compile the text of `build`."""
    return compile_model(mujoco.MjSpec.from_string(text), "model.xml")


def _scene() -> mujoco.MjSpec:
    return mujoco.MjSpec.from_file(str(FOLDER / "scene.xml"))


def _set_options(spec: mujoco.MjSpec, timestep: float) -> None:
    """The solver settings of `scene.xml` for every robot, with the run's timestep."""
    scene = _scene().option
    for name in ("integrator", "cone", "impratio", "jacobian"):
        setattr(spec.option, name, getattr(scene, name))
    spec.option.timestep = timestep


def _ensure_floor(spec: mujoco.MjSpec) -> str:
    """Name of the plane to stand on, with the contact of the shipped scene's floor.

    The shipped scene joins a robot that has no plane.
    """
    planes = [g for g in spec.worldbody.geoms if g.type == mujoco.mjtGeom.mjGEOM_PLANE]
    if not planes:
        scene = _scene()
        scene.option.timestep = spec.option.timestep  # else the two would conflict
        spec.visual.map.znear = scene.visual.map.znear
        spec.attach(scene, frame=spec.worldbody.add_frame(), prefix="scene_")
        return "scene_floor"
    floor, own = planes[0], _scene().geom("floor")
    floor.name = floor.name or "floor"
    floor.priority, floor.solref, floor.solimp = own.priority, own.solref, own.solimp
    return str(floor.name)


def _set_friction(spec: mujoco.MjSpec, robot: Robot, floor: str, value: float) -> None:
    """Sliding friction of floor and feet; the engine takes the floor's."""
    feet = [name for leg in robot.card.legs.values() for name in leg.foot]
    for name in (floor, *feet):
        geom = spec.geom(name)
        geom.friction = (value, *geom.friction[1:])


def _ensure_servos(spec: mujoco.MjSpec, robot: Robot, scenario: Scenario) -> None:
    """One position servo a leg joint, named as the joint; motors give way to it."""
    for leg in robot.card.legs.values():
        for joint in (leg.swing, leg.lift, *leg.hold):
            servo = _servo_of(spec, joint)
            if servo is None:
                servo = _add_servo(spec, robot, joint)
            _tune(servo, scenario.servo_stiffness, scenario.servo_damping)


def _servo_of(spec: mujoco.MjSpec, joint: str) -> mujoco.MjsActuator | None:
    """The joint's position servo; actuators of other kinds are removed."""
    found = None
    on_joints = mujoco.mjtTrn.mjTRN_JOINT
    driving = [a for a in spec.actuators if a.trntype == on_joints]
    for actuator in [a for a in driving if a.target == joint]:
        gain, bias = actuator.gainprm[0], actuator.biasprm[1]
        if gain > 0 and np.isclose(bias, -gain):
            found = actuator
        else:
            spec.delete(actuator)
    return found


def _add_servo(spec: mujoco.MjSpec, robot: Robot, joint: str) -> mujoco.MjsActuator:
    servo = robot.card.servo
    if servo is None:
        raise ModelError(
            f"joint {joint!r} has no position servo: {robot.path}; "
            "give stiffness and damping under [servo] in the card"
        )
    actuator = spec.add_actuator(
        name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    actuator.set_to_position(kp=servo.stiffness, kv=servo.damping)
    return actuator


def _tune(
    servo: mujoco.MjsActuator, stiffness: float | None, damping: float | None
) -> None:
    kp = servo.gainprm[0] if stiffness is None else stiffness
    kv = -servo.biasprm[2] if damping is None else damping
    if stiffness is not None or damping is not None:
        servo.set_to_position(kp=kp, kv=kv)


def _ensure_sensors(spec: mujoco.MjSpec, robot: Robot, floor: str) -> None:
    """Contact sensors of every foot geom and the centre of mass, where missing."""
    present = {sensor.name for sensor in spec.sensors}
    for geom in (name for leg in robot.card.legs.values() for name in leg.foot):
        if contact_sensor(geom) not in present:
            _add_contact_sensor(spec, geom, floor)
    if "center_of_mass" not in present:
        spec.add_sensor(
            name="center_of_mass",
            type=mujoco.mjtSensor.mjSENS_SUBTREECOM,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            objname=robot.root,
        )


def contact_sensor(geom: str) -> str:
    """Name of the contact sensor of a foot geom."""
    return f"contact_{geom}"


def _add_contact_sensor(spec: mujoco.MjSpec, geom: str, floor: str) -> None:
    data = mujoco.mjtConDataField
    fields = (data.mjCONDATA_FOUND, data.mjCONDATA_FORCE, data.mjCONDATA_POS)
    spec.add_sensor(
        name=contact_sensor(geom),
        type=mujoco.mjtSensor.mjSENS_CONTACT,
        objtype=mujoco.mjtObj.mjOBJ_GEOM,
        objname=floor,
        reftype=mujoco.mjtObj.mjOBJ_GEOM,
        refname=geom,
        intprm=[
            sum(1 << int(field) for field in (*fields, data.mjCONDATA_LINVEL)),
            0,
            _SLOTS.get(spec.geom(geom).type, 4),
        ],
    )


def _ensure_start(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Keyframe `start` where missing: the initial pose with its feet on the floor."""
    if "start" in {key.name for key in spec.keys}:
        return
    sunk = Kinematics(robot).stance(np.zeros(len(robot.groups))).height.min()
    root = spec.body(robot.root)
    root.pos = (0.0, 0.0, root.pos[2] - sunk)
    spec.add_key(name="start")


@dataclass(frozen=True)
class Channels:
    """Where a model takes commands: its leg joints' places in ctrl."""

    robot: Robot
    model: mujoco.MjModel

    def ctrl(self, swing: np.ndarray, lift: np.ndarray) -> np.ndarray:
        """Commands of every actuator.

        Args:
            swing: Angle of each group, shape (T, G) [rad].
            lift: How far each group is raised, shape (T, G) [rad].

        Returns:
            Shape (T, nu); actuators that are no leg joint's keep the keyframe's value.
        """
        robot, model = self.robot, self.model
        rows = np.tile(model.key("start").ctrl, (len(swing), 1))
        turned = robot.swing_gain * swing[:, robot.group_of_leg]  # (T, F)
        raised = robot.raise_sign * lift[:, robot.group_of_leg]
        for i, leg in enumerate(robot.legs):
            card = robot.card.legs[leg]
            for joint, angle in ((card.swing, turned[:, i]), (card.lift, raised[:, i])):
                place = actuator_of(model, joint)
                rows[:, place] = robot.standing_angle(joint) + angle
            for joint in card.hold:
                rows[:, actuator_of(model, joint)] = robot.standing_angle(joint)
        return np.ascontiguousarray(rows)

    def swing(self, qpos: np.ndarray) -> np.ndarray:
        """Where the legs are, not where they are told to be: servos lag.

        Args:
            qpos: Shape (T, nq).

        Returns:
            Mean angle of each group's legs, shape (T, G) [rad].
        """
        robot = self.robot
        joints = [robot.card.legs[leg].swing for leg in robot.legs]
        places = [int(self.model.joint(joint).qposadr[0]) for joint in joints]
        standing = np.array([robot.standing_angle(joint) for joint in joints])
        legs = (qpos[:, places] - standing) / robot.swing_gain  # (T, F)
        groups = range(len(robot.groups))
        means = [legs[:, robot.group_of_leg == g].mean(axis=1) for g in groups]
        return np.stack(means, axis=1)


def lift_angle(robot: Robot, lift_height: float | None) -> float:
    """Angle of the lift joints that raises every foot by a height [rad].

    The card's own angle when no height is asked for.

    Raises:
        UsageError: If the legs cannot reach that height.
    """
    if lift_height is None:
        return robot.card.lift_angle
    groups = len(robot.groups)
    up = np.linspace(0, np.pi / 2, 901)
    angles = np.repeat(up[:, None], groups, axis=1)
    rise = Kinematics(robot).stance(np.zeros_like(angles), angles).height
    rise = (rise - rise[0]).min(axis=1)
    if rise.max() < lift_height:
        raise UsageError(
            f"lift_height = {lift_height} cannot be reached",
            robot.name,
            f"give at most {rise.max():.3f} m",
        )
    top = int(rise.argmax())
    return float(np.interp(lift_height, rise[: top + 1], up[: top + 1]))
