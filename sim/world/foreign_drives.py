"""Actuators on tendons, sites and bodies that move a robot's legs beside its servos."""

from __future__ import annotations

import mujoco
import numpy as np

from models import ON_JOINT, Robot

MOVES = 1e-9  # moment of an actuator about a joint, below which it does not move it


def other_drives(robot: Robot) -> list[str]:
    """Names of the actuators that move leg joints from elsewhere than the joint itself.

    Those that are on legs of the card are found by their moments about the leg joints,
    where the robot starts.

    Args:
        robot: Robot as its file has it.
    """
    model = robot.model
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_forward(model, data)
    joints = [joint for leg in robot.card.legs.values() for joint in leg.joints]
    dofs = {int(model.joint(joint).dofadr[0]) for joint in joints}
    found = []
    for actuator in np.flatnonzero(~np.isin(model.actuator_trntype, ON_JOINT)):
        first = data.moment_rowadr[actuator]
        row = slice(first, first + data.moment_rownnz[actuator])
        moves = np.abs(data.actuator_moment[row]) > MOVES
        if dofs & set(data.moment_colind[row][moves].tolist()):
            found.append(model.actuator(int(actuator)).name)
    return found
