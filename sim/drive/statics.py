"""Torques of the lift joints of a robot that stands still, from statics alone."""

from __future__ import annotations

import mujoco
import numpy as np

from models.contact import static_loads
from models.description import actuator_of
from planner import Array
from sim.preparation.setup import Setup


def lift_torques(setup: Setup, down: Array) -> Array:
    """Torque that each lift joint's servo bears, legs at their angles of the start.

    On three feet the loads are determined; on more, feet stand as on equal springs.

    Args:
        setup: The robot in its world.
        down: Which feet stand, shape (F,), bool.

    Returns:
        Shape (F,) [N m], positive where the servo turns its joint forward.
    """
    robot, stance = setup.robot, setup.kinematics.standing
    loads = np.zeros(len(robot.legs))
    feet, center = stance.feet[down], stance.center_of_mass
    shares = static_loads(feet[None], center[None])[0]
    loads[down] = shares * robot.weight_in(setup.model)
    rise = stance.gives[:, 2] * robot.raise_sign  # of each foot by its joint [m/rad]
    torque: Array = own_torques(setup) - loads * rise
    return torque


def own_torques(setup: Setup) -> Array:
    """Torque that holds each leg up in the air, shape (F,) [N m]."""
    model = setup.model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    joints = [actuator_of(model, joint) for joint in setup.robot.lift_joints]
    places = model.jnt_dofadr[model.actuator_trnid[joints, 0]]
    torque: Array = data.qfrc_bias[places].copy()
    return torque
