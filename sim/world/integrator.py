"""The integrator of a run: Euler's, unless the servos are too stiff for the timestep.

Euler's integrator takes springs and servos as they are at the beginning of a step.
The engine's implicit one allows for their damping once friction has been solved for,
which makes standing feet slip in proportion to the timestep. It is stable where
Euler's is not, and is used there.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from planner import Array

NUDGE = 1e-6  # [rad] or [m], and as much a second
STABLE = 1.9  # of `explicitness`, whose limit is 2 where the robot starts


def suitable_integrator(model: mujoco.MjModel) -> mujoco.mjtIntegrator:
    """Euler's where it is stable, and the engine's fast implicit one elsewhere."""
    stable = explicitness(model) < STABLE
    kinds = mujoco.mjtIntegrator
    return kinds.mjINT_EULER if stable else kinds.mjINT_IMPLICITFAST


def explicitness(model: mujoco.MjModel) -> float:
    """How far a velocity changes in one explicit step, as a multiple of itself.

    With inertia M, stiffness K, damping C and timestep h it is the largest eigenvalue
    of M^-1 (h C + h^2 K / 2). Explicit steps grow from 2 on. The damping of the joints
    themselves is left out, since Euler's integrator treats it implicitly as well.
    """
    h, data = model.opt.timestep, mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    start = data.qpos.copy()

    def forces() -> Array:  # of springs, dampers and servos on every freedom, (nv,)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        total: Array = data.qfrc_passive + data.qfrc_actuator
        return total

    def moved(step: Array) -> Array:
        data.qpos[:] = start
        mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        return forces()

    def moving(velocity: Array) -> Array:
        data.qpos[:], data.qvel[:] = start, velocity
        return forces()

    stiffness = _falls(moved, model.nv)
    damping = _falls(moving, model.nv) - np.diag(model.dof_damping)
    change = np.linalg.solve(inertia, h * damping + h**2 / 2 * stiffness)
    return float(np.linalg.eigvals(change).real.max())


def _falls(forces: Callable[[Array], Array], size: int) -> Array:
    """Minus the derivative of forces, by central differences, shape (nv, nv)."""
    steps = NUDGE * np.eye(size)
    return np.stack([forces(-s) - forces(s) for s in steps], axis=-1) / (2 * NUDGE)
