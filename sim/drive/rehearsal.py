"""The torques of a walk, measured by walking it with very stiff servos.

With such servos the joints are where they should be. The torques are therefore those of
the intended motion, including the friction between standing feet. They do not depend on
where on the floor the robot is, so that a walk that is planned on the way is rehearsed
stretch by stretch beside it. The robot of the rehearsal has no imperfections, because
those of the walking robot are not known.
"""

from __future__ import annotations

from copy import copy

import mujoco
import numpy as np

from models.description import actuator_of
from planner import Array
from sim.drive.lead import Lead, smoothed
from sim.motion.schedule import Schedule
from sim.physics.engine import Engine
from sim.preparation.setup import Setup
from sim.world.integrator import suitable_integrator

GIVES = 1 / 800  # [rad]; of a joint under the whole weight at the end of a leg


class Rehearsal:
    """A second robot that walks ahead on stiff servos."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup.as_planned
        self._engine = Engine(stiffened(self._setup))

    def lead(self, schedule: Schedule) -> Lead:
        """Walk a schedule and return the torques that it took.

        Raises:
            SimulationError: If the rehearsal diverges.
        """
        torques = [
            self._engine.advance(ctrl).actuator_force
            for ctrl in self._setup.commands(schedule)
        ]
        return smoothed(np.concatenate(torques), self._setup.limits.timestep)


def stiffened(setup: Setup) -> mujoco.MjModel:
    """The model with servos that hardly give way, critically damped, of any torque."""
    model, joints = copy(setup.model), leg_actuators(setup)
    stiffness = carried_torque(setup) / GIVES
    inertia = model.dof_M0[model.jnt_dofadr[model.actuator_trnid[joints, 0]]]
    model.actuator_gainprm[joints, 0] = stiffness
    model.actuator_biasprm[joints, 1] = -stiffness
    model.actuator_biasprm[joints, 2] = -2 * np.sqrt(stiffness * inertia)
    model.actuator_forcelimited[joints] = 0
    model.opt.integrator = suitable_integrator(model)
    return model


def leg_actuators(setup: Setup) -> Array:
    """Actuators of all leg joints, shape (J,)."""
    joints = setup.robot.card.joints
    return np.array([actuator_of(setup.model, joint) for joint in joints])


def carried_torque(setup: Setup) -> float:
    """Torque of the whole weight at the end of a leg [N m]."""
    return _reach(setup) * setup.robot.weight_in(setup.model)


def _reach(setup: Setup) -> float:
    """Longest distance of a foot from its swing axis [m]: the foot's way per radian."""
    stance = setup.kinematics.standing
    own = np.linalg.norm(stance.rates, axis=-1) / np.abs(setup.robot.swing_gain)
    return float(own.max())
