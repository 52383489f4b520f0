"""What would move or hold a robot beside servos: actuators, equations of its file.

Which of them do is found from their moments and slopes where the robot starts.
"""

from copy import copy

import mujoco
import numpy as np

from models import Robot
from models.description import ON_JOINT
from planner import Array

COUPLING = (int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON))
TORN = 0.01  # of an equation's slopes, within which joints that nothing drives follow
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


def sprung(model: mujoco.MjModel) -> Array:
    """Which joints have springs, of whatever law, (njnt,)."""
    laws = np.column_stack([model.jnt_stiffness, model.jnt_stiffnesspoly])
    return np.asarray(laws.any(axis=1))


def slowed(model: mujoco.MjModel) -> Array:
    """Which freedoms of joints have damping, of whatever law, or friction, (nv,)."""
    laws = model.dof_damping, model.dof_dampingpoly, model.dof_frictionloss
    return np.asarray(np.column_stack(laws).any(axis=1))


def holds_body(robot: Robot) -> bool:
    """Whether the body's own joint has damping, friction, springs or armature."""
    model, root = robot.model, robot.model.body(robot.root)
    dofs = slice(root.dofadr[0], root.dofadr[0] + 6)
    held = slowed(model)[dofs].any() or model.dof_armature[dofs].any()
    return bool(held or sprung(model)[root.jntadr[0]])


def couplings(robot: Robot) -> list[int]:
    """Equations that tie leg joints, to one another or to the body, or the robot down.

    Those that close a linkage within a leg, with joints that nothing drives, stay.
    """
    model, legs = copy(robot.model), robot.card.legs.values()
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data, driven = _at_start(model, robot)
    slopes = data.efc_J.reshape(-1, model.nv)[: data.nefc]  # room may be left behind
    dofs = [[model.joint(j).dofadr[0] for j in (leg.swing, leg.lift)] for leg in legs]
    first = model.body(robot.root).dofadr[0]
    passive = [*{*range(model.nv)} - {*range(first, first + 6)} - driven]
    moved = (np.abs(slopes[:, dofs]) > MOVES).any(axis=2)  # a column a leg
    equal = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    rows = [equal & (data.efc_id == number) for number in range(model.neq)]
    count = np.array([moved[own].any(axis=0).sum() for own in rows], dtype=int)
    torn = [_tears(slopes[own], [*driven], passive) for own in rows]
    alone = np.array(torn, dtype=bool) | np.isin(model.eq_type, COUPLING)
    coupling = (count > 1) | ((count > 0) & alone)
    sites = model.eq_objtype == int(mujoco.mjtObj.mjOBJ_SITE)
    placed = sites | (model.eq_objtype == int(mujoco.mjtObj.mjOBJ_BODY))
    ends = np.stack([model.eq_obj1id, model.eq_obj2id]) * placed
    ends[:, sites] = model.site_bodyid[ends[:, sites]]
    own = model.body_rootid[ends] == model.body(robot.root).id
    weld = model.body_weldid[ends]
    fixed = (weld == 0) | (model.body_mocapid[weld] >= 0)
    held = own.any(axis=0) & fixed.any(axis=0) & (data.eq_active > 0)
    return np.flatnonzero(coupling | held).tolist()


def _tears(slopes: Array, driven: list[int], passive: list[int]) -> bool:
    """Whether joints that nothing drives cannot follow the others within equations."""
    free, told = slopes[:, passive], slopes[:, driven]
    left = np.abs(told - free @ np.linalg.pinv(free) @ told)
    return bool(left.max(initial=0.0) > TORN * np.abs(told).max(initial=0.0))


def loose_joints(robot: Robot) -> list[str]:
    """Joints of other parts that nothing holds or slows, and no actuator moves."""
    model = robot.model
    held = slowed(model)[model.jnt_dofadr] | sprung(model)
    held[model.actuator_trnid[np.isin(model.actuator_trntype, ON_JOINT), 0]] = True
    free = model.jnt_type == mujoco.mjtJoint.mjJNT_FREE
    names = (model.joint(int(number)).name for number in np.flatnonzero(~held & ~free))
    return [name for name in names if name not in robot.card.joints]


def _at_start(model: mujoco.MjModel, robot: Robot) -> tuple[mujoco.MjData, set[int]]:
    """The model where the robot starts, and the dofs of its leg joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_forward(model, data)
    return data, {int(model.joint(joint).dofadr[0]) for joint in robot.card.joints}
