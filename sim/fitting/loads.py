"""What a robot's joints bear while they follow a log: on a stand, or on the floor.

On a stand the legs hang from a body that is held level, and their weight is all. On the
floor the engine walks the commands with the servos as they are known so far, which
decides how the feet share the load; it depends on the servos little.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from planner import Array
from sim.drive.feed_forward import leg_actuators
from sim.fitting.servo_law import Commanded
from sim.logs.log import Log
from sim.physics.engine import STRETCH, Engine
from sim.preparation.setup import Setup
from sim.world.dead_bands import BAND

LAW_STEP = 0.004  # [s] of the law, which is solved exactly in between
KNOTS = 10  # steps from one evaluation of weights to the next
GOING = 1.0  # [s] in which the robot goes from its start to the log's first row
LIGHTEST = 1e-7  # [kg m^2]
SETTLING = 0.5  # [s] that it then stands


def on_stand(setup: Setup, log: Log) -> Commanded:
    """The log's joints on a robot whose body is held, level as it starts."""
    model = setup.as_planned.model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    places = [int(model.joint(j).qposadr[0]) for j in log.joints]
    dofs = _dofs(model, log)
    time = np.arange(int(log.duration / LAW_STEP) + 1) * LAW_STEP
    knots = np.append(time[::KNOTS], log.duration)
    weights, all_forces = np.empty((len(knots), len(log.joints))), np.empty(model.nv)
    for knot, angles in enumerate(log.at(knots)):
        data.qpos[places] = angles
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_rne(model, data, 0, all_forces)
        weights[knot] = all_forces[dofs]
    load = [np.interp(time, knots, weight) for weight in weights.T]
    torque = np.stack(load, axis=1)
    return Commanded(LAW_STEP, log.at(time), torque, *_inertia(model, dofs))


def on_floor(setup: Setup, model: mujoco.MjModel, log: Log, servos: Array) -> Commanded:
    """The log's joints on a robot that walks in a model, whose servos are (J, 6).

    What a joint bears is what its spring gives and neither its damping nor its inertia
    takes. Raises SimulationError where the simulation diverges.
    """
    dt, actuators = model.opt.timestep, _servos(setup, log)
    ahead = round((GOING + SETTLING) / dt)
    time = np.arange(-ahead, round(log.duration / dt) + 1) * dt
    rows = np.tile(model.key("start").ctrl, (len(time), 1))
    part = np.clip((time + GOING + SETTLING) / GOING, 0, 1)[:, None]
    part = part * part * (3 - 2 * part)
    rows[:, actuators] += part * (log.at(time) + servos[:, 4] - rows[:, actuators])
    engine = Engine(model)
    pieces = range(0, len(rows), STRETCH)
    records = [engine.advance(rows[i : i + STRETCH]) for i in pieces]
    qpos = np.concatenate([record.qpos for record in records])
    speed = np.gradient(turned(model, qpos, log.joints, BAND), dt, axis=0)
    spring = rows[:, actuators] - turned(model, qpos, log.joints)
    inertia, leg = _inertia(setup.as_planned.model, _dofs(setup.as_planned.model, log))
    load = model.actuator_gainprm[actuators, 0] * spring - np.exp(servos[:, 1]) * speed
    load -= inertia * np.gradient(speed, dt, axis=0)
    begins = np.arange(ahead, len(time), round(LAW_STEP / dt))
    mean = np.add.reduceat(load, begins)
    mean /= np.diff(np.append(begins, len(time)))[:, None]
    return Commanded(LAW_STEP, log.at(time[begins]), mean, inertia, leg)


def turned(
    model: mujoco.MjModel, qpos: Array, joints: Sequence[str], *parts: str
) -> Array:
    """Angles (T, J) of joints, and of those named by a part and them, in sum."""
    there = {model.joint(j).name: int(model.jnt_qposadr[j]) for j in range(model.njnt)}
    names = [(joint, *(part + joint for part in parts)) for joint in joints]
    places = [[there[name] for name in each if name in there] for each in names]
    return np.stack([qpos[:, place].sum(axis=1) for place in places], axis=1)


def known_servos(setup: Setup, log: Log) -> tuple[Array, Array]:
    """Stiffness and damping of the log's joints as the robot has them, (J,) each."""
    model, servos = setup.as_planned.model, _servos(setup, log)
    damping = model.dof_damping[_dofs(model, log)] - model.actuator_biasprm[servos, 2]
    return model.actuator_gainprm[servos, 0].copy(), damping


def _inertia(model: mujoco.MjModel, dofs: Array) -> tuple[Array, Array]:
    """About joints, (J,), with their rotors and without [kg m^2]."""
    whole = model.dof_M0[dofs]
    return whole, np.maximum(whole - model.dof_armature[dofs], LIGHTEST)


def _servos(setup: Setup, log: Log) -> Array:
    joints = setup.robot.card.joints
    return leg_actuators(setup)[[joints.index(joint) for joint in log.joints]]


def _dofs(model: mujoco.MjModel, log: Log) -> Array:
    return np.array([int(model.joint(joint).dofadr[0]) for joint in log.joints])
