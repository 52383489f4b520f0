"""Keyframe `start`: the pose in which a robot begins, its feet on the floor."""

from __future__ import annotations

import mujoco
import numpy as np

from models import Kinematics, Robot
from models.description import ON_JOINT
from sim.world.floor import Floor
from sim.world.imperfections import PLAY

START = "start"
SIZES = {mujoco.mjtJoint.mjJNT_FREE: 7, mujoco.mjtJoint.mjJNT_BALL: 4}  # in qpos
AJAR = 1e-4  # [m]; smaller distances of the feet from the floor are left as they are


def ensure_start(spec: mujoco.MjSpec, robot: Robot, floor: Floor) -> float:
    """Write keyframe `start`: the robot's own, at x = y = yaw = 0, feet on the floor.

    Other keyframes go, since their commands may no longer fit.

    Args:
        spec: World with the robot in it and its servos in place.
        robot: Robot that starts.
        floor: Floor that its feet are put on.

    Returns:
        How far the robot was let down onto the floor, or lifted out of it if negative,
        from where its file puts it [m].
    """
    for key in list(spec.keys):
        spec.delete(key)
    qpos, down = Kinematics(robot).level_qpos, _above(robot, floor)
    qpos[robot.root_address + 2] -= down
    for place in _added(spec):
        qpos = np.insert(qpos, place, 0.0)
    spec.add_key(name=START, qpos=qpos, ctrl=_ctrl(spec, robot))
    return down


def _added(spec: mujoco.MjSpec) -> list[int]:
    """Places in qpos of the joints that stand for the play of gears, ascending."""
    places, at = [], 0
    for joint in spec.joints:
        if joint.name.startswith(PLAY):
            places.append(at)
        at += SIZES.get(joint.type, 1)
    return places


def _above(robot: Robot, floor: Floor) -> float:
    """How far the lowest foot is above the floor; 0 where it is next to nothing [m]."""
    stance = Kinematics(robot).standing
    above = float(stance.height.min() - floor.height)
    return above if abs(above) > AJAR else 0.0


def _ctrl(spec: mujoco.MjSpec, robot: Robot) -> list[float]:
    """Leg joints hold their angles; other actuators keep what the robot's file says."""
    own = {robot.model.actuator(i).name: c for i, c in enumerate(robot.start_ctrl)}
    return [
        robot.standing_angle(actuator.target)
        if actuator.trntype in ON_JOINT and actuator.target in robot.card.joints
        else own.get(actuator.name, 0.0)
        for actuator in spec.actuators
    ]
