"""Compilation of MJCF with errors of one line, and look-ups in the compiled model."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np

from models.description.numbers import check_model, check_names
from models.errors import ModelError
from planner import Array

ON_JOINT = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


def compile_model(spec: mujoco.MjSpec, source: str) -> mujoco.MjModel:
    """Compile, refusing what the compiler does, and odd names and numbers."""
    silence_the_engine()
    with (
        one_line(f"{_language(source)} does not compile: {source}"),
        warnings.catch_warnings(action="ignore"),  # hints on style, many lines
    ):
        model = spec.compile()
    check_names(model, source)
    check_model(model, source)
    return model


@contextmanager
def one_line(what: str, *remedy: str) -> Iterator[None]:
    """Turn refusals of the engine into a `ModelError` that gives their reason."""
    try:
        yield
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError("; ".join((what, reason, *remedy))) from error


def _language(source: str) -> str:
    return "URDF" if source.lower().endswith(".urdf") else "MJCF"


def silence_the_engine() -> None:
    """What the engine warns of is raised as an error; no need to print and log it."""
    log = mujoco.MjLogConfig.get()
    log.logto_file = log.logto_console = False
    log.set()


def read_spec(path: Path) -> mujoco.MjSpec:
    """A fresh, editable copy of an MJCF file."""
    silence_the_engine()
    with one_line(f"not a usable {_language(str(path))} file: {path}"):
        return mujoco.MjSpec.from_file(str(path))


def named(spec: mujoco.MjSpec) -> None:
    """Name what has no name, so that cards and messages can.

    Geoms and bodies are called after their body and number, actuators of a joint after
    the joint.
    """
    kinds = {"body": spec.bodies, "geom": spec.geoms, "actuator": spec.actuators}
    taken = {part.name for parts in kinds.values() for part in parts}
    for kind, parts in kinds.items():
        for number, part in enumerate(parts):
            if not part.name:
                name = f"{kind}_{number}"
                if kind != "actuator":
                    name = f"{part.parent.name or 'robot'}_{name}"
                elif part.trntype in ON_JOINT:
                    name = part.target
                while name in taken:
                    name += "_"
                taken.add(name)
                part.name = name


def is_position_servo(gain: float, bias: float) -> bool:
    """Whether an actuator's force is a gain times what is left to its command.

    Gain `gainprm[0]` and bias `biasprm[1]`, the latter per unit of the joint's angle.
    """
    return bool(gain > 0 and np.isclose(bias, -gain))


def actuators_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Indices of the actuators that drive a joint."""
    on_joints = np.isin(model.actuator_trntype, ON_JOINT)
    same = model.actuator_trnid[:, 0] == model.joint(joint).id
    return [int(i) for i in np.flatnonzero(on_joints & same)]


def actuator_of(model: mujoco.MjModel, joint: str) -> int:
    """Index of the first actuator that drives a joint; refused if there is none."""
    found = actuators_of(model, joint)
    if not found:
        raise ModelError(f"no actuator drives joint {joint!r}: give it a servo")
    return found[0]


def root_body(model: mujoco.MjModel, path: Path) -> int:
    """Index of the body that carries the free joint; refused if not exactly one."""
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if len(free) != 1:
        owners = [model.body(int(model.jnt_bodyid[j])).name for j in free]
        of = f", of bodies {', '.join(map(repr, owners))}" if owners else ""
        raise ModelError(
            f"{len(free)} free joints{of}: {path}; a walking robot has exactly one, "
            "on its body (<freejoint/>); leave other loose things out"
        )
    return int(model.jnt_bodyid[free[0]])


def levelled(model: mujoco.MjModel, root: int, qpos: Array) -> Array:
    """A configuration with its root level and at x = y = yaw = 0, shape (nq,)."""
    level, address = qpos.copy(), int(model.jnt_qposadr[model.body(root).jntadr[0]])
    level[address : address + 2] = 0.0
    level[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
    return level


def joints_above(model: mujoco.MjModel, body: int) -> list[int]:
    """Joints between a body and the world, from the body upward; free ones left out."""
    found = []
    while body:
        begin, count = model.body_jntadr[body], model.body_jntnum[body]
        found += [int(j) for j in range(begin, begin + count)]
        body = int(model.body_parentid[body])
    return [j for j in found if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
