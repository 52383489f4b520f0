"""What moves or binds a robot's leg joints beside their servos.

These are actuators on tendons, sites and bodies, and equations that couple joints.
"""

from __future__ import annotations

from copy import copy

import mujoco
import numpy as np

from models import Robot
from models.description import ON_JOINT

COUPLING = (int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON))
MOVES = 1e-9  # moment of an actuator about a joint, below which it does not move it


def other_drives(robot: Robot) -> list[str]:
    """Names of the actuators that move leg joints from elsewhere than the joint itself.

    Those that are on legs of the card are found by their moments about the leg joints,
    where the robot starts.

    Args:
        robot: Robot as its file has it.
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
    """Which of the file's equations tie leg joints to others, directly or by tendons.

    Args:
        robot: Robot as its file has it.
    """
    model = copy(robot.model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data, dofs = _at_start(model, robot)
    rows = data.efc_J.reshape(-1, model.nv)
    return sorted(
        {
            int(number)
            for kind, number, row in zip(data.efc_type, data.efc_id, rows, strict=True)
            if kind == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
            and model.eq_type[number] in COUPLING
            and dofs & set(np.flatnonzero(np.abs(row) > MOVES).tolist())
        }
    )


def _at_start(model: mujoco.MjModel, robot: Robot) -> tuple[mujoco.MjData, set[int]]:
    """The model where the robot starts, and the dofs of its leg joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_forward(model, data)
    return data, {int(model.joint(joint).dofadr[0]) for joint in robot.card.joints}
