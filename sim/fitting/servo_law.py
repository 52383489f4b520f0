"""What joints on their servos answer to commands, and what they bear meanwhile.

The law is that of the simulated servos: a spring from the command to the joint with a
dead band, a motor that brakes the joint all the while, and behind it gears with
backlash, in which the leg rests on the side to which its load pushes:

    I a + d v = k (e - clip(e, -w/2, w/2)) - load,   e = command + zero - angle

Between steps it is solved exactly, within the band and outside it. The delay shifts
what is answered. On a stand the legs hang from a body that is held level, and the load
is their weight. On the floor the engine walks the commands with the servos as they are
known so far, which decides how the feet share the load; it depends on the servos
little.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from models.description import actuators_driving
from planner import Array
from sim.logs.log import LONGEST_LOG, Log
from sim.physics.engine import STRETCH, Engine
from sim.preparation.setup import Setup
from sim.world.dead_bands import band_in
from sim.world.imperfections import RUBBED, turned
from sim.world.servos import Channels

LAW_STEP = 0.004  # [s] of the law, which is solved exactly in between
GOING = 1.0  # [s] in which the robot goes from its start to the log's first row
LIGHTEST, LAG = 1e-7, 1e-3  # [kg m^2], [s] by which servos without damping brake
NEAR_RATE = 1.02  # ratio of rates of rows and of commands, below which these are those
SETTLING = 0.5  # [s] that it then stands


@dataclass(frozen=True, eq=False)
class Commanded:
    """Angles that joints are asked for, in equal steps of time, and their loads."""

    step: float  # [s]
    angle: Array  # on the average of the step that ends, (T, P) [rad]
    load: Array  # torque of gravity and floor against the joint's angle, (T, P) [N m]
    inertia: Array  # about every joint, rotor and leg, (P,) [kg m^2]
    leg: Array  # of that, what the backlash lets loose, (P,) [kg m^2]

    def answers(self, servos: Array, rows: Array) -> Array:
        """Angles (V, N, P) at times (N,) [s] of variants of servos, (V, P, 6).

        A servo is log stiffness, log damping, dead band, backlash, zero and delay.
        """
        k, d = np.exp(servos[..., 0]).ravel(), np.exp(servos[..., 1]).ravel()
        w, b = servos[..., 2].ravel() / 2, servos[..., 3].ravel() / 2
        lanes = len(servos)
        inertia = np.tile(self.inertia, lanes)
        asked = np.tile(self.angle, (1, lanes)) + servos[..., 4].ravel()
        load = np.tile(self.load, (1, lanes))
        held, free = (_step(c / inertia, d / inertia, self.step) for c in (k, 0 * k))
        pulled, falls = np.array([1 - held[0, 0], -held[1, 0]]), self.step - free[0, 1]
        falls = np.array([falls, 1 - free[1, 1]]) / d  # under a unit's load
        held_v, free_v = (m[:, 1] - [[0.0], [1.0]] for m in (held, free))
        falls, bent, angle = load[:, None] * falls, load / k, np.empty_like(asked)
        x = np.array([asked[0] - bent[0] - np.sign(load[0]) * w, 0 * k])
        s, u = -np.sign(load[0]) * b, 0 * k  # of the leg, from the motor
        kept = np.exp(-self.step * RUBBED / np.tile(self.leg, lanes))
        fallen = load * (1 - kept) / RUBBED
        for t in range(len(asked)):
            e = asked[t] - x[0]
            rest = e - np.minimum(np.maximum(e, -w), w) - bent[t]
            held, free = pulled * rest + held_v * x[1], free_v * x[1] - falls[t]
            before = np.abs(e) - w
            after = np.abs(e - np.where(before > 0, held[0], free[0])) - w
            out = np.maximum(before, 0) + np.maximum(after, 0)  # of the band, of a step
            out /= np.abs(before) + np.abs(after) + 1e-300  # nothing beside angles
            x += (moved := free + out * (held - free))
            u = kept * (u - moved[1]) - fallen[t]
            loose = s + self.step * u
            s = np.minimum(np.maximum(loose, -b), b)
            u = np.where(s == loose, u, 0.0)
            angle[t] = x[0] + s
        return self._at(angle, rows, servos)

    def _at(self, angle: Array, rows: Array, servos: Array) -> Array:
        """Evenly between steps, as late as the servos are."""
        lanes, joints = servos.shape[:2]
        late = rows[None, :, None] - servos[:, None, :, 5]
        place = np.clip(late / self.step, 0.0, len(angle) - 1.001)
        before = place.astype(int)
        lane = np.arange(lanes * joints).reshape(lanes, 1, joints)
        part = place - before
        return (1 - part) * angle[before, lane] + part * angle[before + 1, lane]


def _step(k: Array, d: Array, step: float) -> Array:
    """What x and v become of x and v in a step of v' = -k x - d v, (2, 2, L)."""
    far = -d / 2 - np.sqrt(d**2 / 4 - k + 0j)  # the characteristic roots
    near = k / far
    apart, grown = step * (far - near), np.exp(step * near)
    same = apart == 0
    both = step * grown * np.where(same, 1, np.expm1(apart) / (apart + same))
    return np.array([[grown - near * both, both], [-k * both, grown + far * both]]).real


def on_stand(setup: Setup, log: Log) -> Commanded:
    """The log's joints on a robot whose body is held, level as it starts."""
    model = setup.as_planned.model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    places = [int(model.joint(j).qposadr[0]) for j in log.joints]
    dofs = _dofs(model, log)
    time = np.arange(int(log.duration / LAW_STEP) + 1) * LAW_STEP
    knots = np.append(time[::10], log.duration)
    weights, all_forces = np.empty((len(knots), len(log.joints))), np.empty(model.nv)
    for knot, angles in enumerate(log.at(knots)):
        data.qpos[places] = angles
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_rne(model, data, 0, all_forces)
        weights[knot] = all_forces[dofs]
    load = np.stack([np.interp(time, knots, w) for w in weights.T], axis=1)
    return Commanded(LAW_STEP, _asked(setup, log, time), load, *_inertia(model, dofs))


def on_floor(setup: Setup, model: mujoco.MjModel, log: Log, servos: Array) -> Commanded:
    """The log's joints on a robot that walks in a model, whose servos are (J, 6).

    What a joint bears is what its spring gives and neither its damping nor its inertia
    takes. Raises SimulationError where the simulation diverges.
    """
    dt, actuators = model.opt.timestep, actuators_driving(setup.model, log.joints)
    ahead = round((GOING + SETTLING) / dt)
    time = np.arange(-ahead, round(log.duration / dt) + 1) * dt
    rest = model.key("start").ctrl[actuators]
    part = np.clip((time + GOING + SETTLING) / GOING, 0, 1)[:, None]
    part = part * part * (3 - 2 * part)
    told = rest + part * (_asked(setup, log, time + dt) + servos[:, 4] - rest)
    rows = Channels(setup.robot, model).ctrl(dict(zip(log.joints, told.T, strict=True)))
    engine = Engine(model)
    pieces = range(0, len(rows), STRETCH)
    records = [engine.advance(rows[i : i + STRETCH]) for i in pieces]
    qpos = np.concatenate([record.qpos for record in records])
    angles = turned(model, qpos, log.joints)
    speed, spring = np.gradient(angles, dt, axis=0), told - angles
    within = np.array([band_in(model, joint) / 2 for joint in log.joints])
    spring -= np.clip(spring, -within, within)
    inertia, leg = _inertia(setup.as_planned.model, _dofs(setup.as_planned.model, log))
    load = model.actuator_gainprm[actuators, 0] * spring - np.exp(servos[:, 1]) * speed
    load -= inertia * np.gradient(speed, dt, axis=0)
    steps = max(round(LAW_STEP / dt), 1)
    begins = np.arange(ahead, len(time), steps)
    counts = np.diff(np.append(begins, len(time)))[:, None]
    mean = np.add.reduceat(load, begins) / counts
    return Commanded(steps * dt, _asked(setup, log, time[begins]), mean, inertia, leg)


def _asked(setup: Setup, log: Log, time: Array) -> Array:
    """Means of commands since the time before, at even times (T,), shape (T, J).

    Where rows come as servos take commands, each is held until the next one.
    """
    a_row = setup.servo.rate * float(np.median(np.diff(log.time)))
    ends = np.append(2 * time[0] - time[1], time)
    if not 1 / NEAR_RATE < a_row < NEAR_RATE:
        return (log.at(ends[1:]) + log.at(ends[:-1])) / 2
    rows = np.array([-LONGEST_LOG, *log.time[1:], 2 * LONGEST_LOG])
    so_far = np.cumsum(log.commanded * np.diff(rows)[:, None], axis=0)
    until = np.stack([np.interp(ends, rows, [0, *a]) for a in so_far.T], axis=1)
    return np.diff(until, axis=0) / np.diff(ends)[:, None]


def known_servos(setup: Setup, log: Log) -> tuple[Array, Array]:
    """Stiffness and damping of the log's joints as the robot has them, (J,) each."""
    model, servos = setup.as_planned.model, actuators_driving(setup.model, log.joints)
    damping = model.dof_damping[_dofs(model, log)] - model.actuator_biasprm[servos, 2]
    stiffness = model.actuator_gainprm[servos, 0].copy()
    return stiffness, np.where(damping > 0, damping, LAG * stiffness)


def _inertia(model: mujoco.MjModel, dofs: Array) -> tuple[Array, Array]:
    """About joints, (J,), with their rotors and without [kg m^2]."""
    whole = model.dof_M0[dofs]
    return whole, np.maximum(whole - model.dof_armature[dofs], LIGHTEST)


def _dofs(model: mujoco.MjModel, log: Log) -> Array:
    return np.array([int(model.joint(joint).dofadr[0]) for joint in log.joints])
