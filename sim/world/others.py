"""What would move or hold a robot beside servos: actuators, equations of its file.

Which of them do is found from their moments and slopes where the robot starts.
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
    """Names of actuators that move leg joints or the body otherwise than by a joint.

    What sticks to the floor has a moment only where it touches, and is found anyway.
    """
    model, root = robot.model, robot.model.body(robot.root)
    data, dofs = _at_start(model, robot)
    on, at = model.actuator_trntype, model.actuator_trnid[:, 0]
    own = data.moment_rownnz, data.moment_rowadr
    moment = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(moment, data.actuator_moment, *own, data.moment_colind)
    moved = [*dofs, *range(root.dofadr[0], root.dofadr[0] + 6)]
    moves = (np.abs(moment[:, moved]) > MOVES).any(axis=1)
    joint, body = np.isin(on, ON_JOINT), on == mujoco.mjtTrn.mjTRN_BODY
    alone = joint & (model.jnt_bodyid[at * joint] != root.id)
    sticks = body & (model.body_rootid[at * body] == root.id)
    found = np.flatnonzero(moves & ~alone | sticks)
    return [model.actuator(int(number)).name for number in found]


def couplings(robot: Robot) -> list[int]:
    """Equations that tie leg joints to others, also by tendons, or the robot down."""
    model = copy(robot.model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data, dofs = _at_start(model, robot)
    slopes = data.efc_J.reshape(-1, model.nv)[: data.nefc]  # room may be left behind
    moved = np.abs(slopes[:, sorted(dofs)]) > MOVES
    equal = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    numbers = np.unique(data.efc_id[equal & moved.any(axis=1)])
    coupling = numbers[np.isin(model.eq_type[numbers], COUPLING)]
    sites = model.eq_objtype == int(mujoco.mjtObj.mjOBJ_SITE)
    placed = sites | (model.eq_objtype == int(mujoco.mjtObj.mjOBJ_BODY))
    ends = np.stack([model.eq_obj1id, model.eq_obj2id]) * placed
    ends[:, sites] = model.site_bodyid[ends[:, sites]]
    own = model.body_rootid[ends] == model.body(robot.root).id
    weld = model.body_weldid[ends]
    fixed = (weld == 0) | (model.body_mocapid[weld] >= 0)
    held = own.any(axis=0) & fixed.any(axis=0) & (data.eq_active > 0)
    return np.union1d(coupling, np.flatnonzero(held)).astype(int).tolist()


def _at_start(model: mujoco.MjModel, robot: Robot) -> tuple[mujoco.MjData, set[int]]:
    """The model where the robot starts, and the dofs of its leg joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_forward(model, data)
    return data, {int(model.joint(joint).dofadr[0]) for joint in robot.card.joints}
