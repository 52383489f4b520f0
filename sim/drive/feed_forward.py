"""Feed-forward: the torques that a walk takes, and commands that make up for them.

A servo is a spring: a joint that bears a torque rests away from its command by torque
over stiffness, and a moving one lags by damping times speed over stiffness. Commands
are ahead by as much. Torques are measured in a walk beforehand, on very stiff servos.
"""

from copy import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from models.description import actuators_driving
from planner import Array
from sim.preparation.setup import Setup
from sim.world.model import suitable_integrator

GIVES = 1 / 800  # [rad]; of a joint under the whole weight at the end of a leg
SMOOTHED = 0.05  # [s]; over which torques are averaged, as servos cannot follow faster


@dataclass(frozen=True)
class FeedForward:
    """Smooth values along a stretch of a schedule: torques of actuators, or angles."""

    values: Array  # at knots, the first one at the stretch's first step, (K, n)
    spacing: int  # steps between knots

    def at(self, rows: Array) -> Array:
        """Values at steps of the stretch, one row a step."""
        where = np.minimum(rows / self.spacing, len(self.values) - 1.0)
        before = np.minimum(where.astype(int), max(len(self.values) - 2, 0))
        after = np.minimum(before + 1, len(self.values) - 1)
        part = (where - before)[:, None]
        return (1 - part) * self.values[before] + part * self.values[after]


def smoothed(values: Array, timestep: float) -> FeedForward:
    """Values of every step, one row a step, averaged over 50 ms, every 5 ms."""
    from scipy.ndimage import uniform_filter1d  # slow to import, and seldom needed

    window = 2 * round(SMOOTHED / timestep / 2) + 1  # odd, so that nothing is shifted
    spacing = max(round(0.005 / timestep), 1)  # [s] between knots
    smooth = uniform_filter1d(values, window, axis=0, mode="nearest")
    return FeedForward(smooth[::spacing].copy(), spacing)


def stiffened(setup: Setup) -> mujoco.MjModel:
    """The model on very stiff, critically damped servos without a largest torque."""
    model = copy(setup.model)
    joints = actuators_driving(model, setup.robot.card.joints)
    stiffness = carried_torque(setup) / GIVES
    inertia = model.dof_M0[model.jnt_dofadr[model.actuator_trnid[joints, 0]]]
    model.actuator_gainprm[joints, 0] = stiffness
    model.actuator_biasprm[joints, 1] = -stiffness
    model.actuator_biasprm[joints, 2] = -2 * np.sqrt(stiffness * inertia)
    model.actuator_forcelimited[joints] = 0
    model.opt.integrator = suitable_integrator(model)
    return model


def carried_torque(setup: Setup) -> float:
    """Torque of the whole weight at the end of the longest leg, as it swings [N m]."""
    rates = np.linalg.norm(setup.kinematics.standing.rates, axis=-1)
    reach = float((rates / np.abs(setup.robot.swing_gain)).max())
    return reach * setup.robot.weight_in(setup.model)
