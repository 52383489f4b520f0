"""Looking things up in a compiled model by name, and compiling with clear refusals."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from models.errors import ModelError

ON_JOINT = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
FINITE = (  # what the compiler lets pass; the last one is derived from all the others
    "body_mass", "body_inertia", "body_pos", "body_quat", "body_ipos", "body_iquat",
    "jnt_axis", "jnt_pos", "jnt_range", "dof_armature", "dof_damping",
    "geom_pos", "geom_quat", "geom_size", "geom_friction", "geom_solref",
    "actuator_gainprm", "actuator_biasprm", "actuator_gear", "actuator_ctrlrange",
    "key_qpos", "key_ctrl", "body_invweight0",
)  # fmt: skip


def compile_model(spec: mujoco.MjSpec, source: str) -> mujoco.MjModel:
    """Compile, turning every refusal of the compiler into one line.

    Raises:
        ModelError: If the compiler refuses, or a number in the model is not finite.
    """
    try:
        model = spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"MJCF does not compile: {source}; {reason}") from error
    _check_finite(model, source)
    return model


def _check_finite(model: mujoco.MjModel, source: str) -> None:
    for name in FINITE:
        bad = np.argwhere(~np.isfinite(getattr(model, name)))
        if len(bad):
            raise ModelError(
                f"{name} of {_owner(model, name, int(bad[0, 0]))} is not finite: "
                f"{source}; give it a number"
            )


def _owner(model: mujoco.MjModel, array: str, row: int) -> str:
    """The element that a row of one of the model's arrays belongs to."""
    kind = array.partition("_")[0]
    if kind == "dof":
        row = int(model.dof_jntid[row])
    kind = {"dof": "joint", "jnt": "joint"}.get(kind, kind)
    name = getattr(model, kind)(row).name
    return f"{kind} {name!r}" if name else f"{kind} {row}"


def read_spec(path: Path) -> mujoco.MjSpec:
    """A fresh, editable copy of an MJCF file.

    Raises:
        ModelError: If the file is not MJCF.
    """
    try:
        return mujoco.MjSpec.from_file(str(path))
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"not a usable MJCF file: {path}; {reason}") from error


def actuators_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Indices of the actuators that drive a joint."""
    on_joints = np.isin(model.actuator_trntype, ON_JOINT)
    same = model.actuator_trnid[:, 0] == model.joint(joint).id
    return [int(i) for i in np.flatnonzero(on_joints & same)]


def actuator_of(model: mujoco.MjModel, joint: str) -> int:
    """Index of the first actuator that drives a joint.

    Raises:
        ModelError: If there is none.
    """
    found = actuators_of(model, joint)
    if not found:
        raise ModelError(f"no actuator drives joint {joint!r}: give it a servo")
    return found[0]


def root_body(model: mujoco.MjModel, path: Path) -> int:
    """Index of the body that carries the free joint.

    Raises:
        ModelError: If there is not exactly one free joint.
    """
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if len(free) != 1:
        raise ModelError(
            f"{len(free)} free joints: {path}; a walking robot has exactly one, "
            "on its body (<freejoint/>)"
        )
    return int(model.jnt_bodyid[free[0]])


def free_joint(model: mujoco.MjModel, root: str) -> int:
    """Where the seven numbers of a body's free joint begin in qpos."""
    return int(model.jnt_qposadr[model.body(root).jntadr[0]])


def joints_above(model: mujoco.MjModel, body: int) -> list[int]:
    """Joints between a body and the world, from the body upward; free ones left out."""
    found = []
    while body:
        begin, count = model.body_jntadr[body], model.body_jntnum[body]
        found += [int(j) for j in range(begin, begin + count)]
        body = int(model.body_parentid[body])
    return [j for j in found if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
