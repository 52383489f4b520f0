"""Counts of lift joints, such that standing feet keep their load; and their torques.

One count moves a foot about as far as its load bends the servo, so that a standing leg
that changed by a count would lift off. A lift joint therefore keeps one count while the
same feet stand. A foot passes the heights at which it may touch in a single command,
with which standing feet change their counts, too. Finer counts follow the loads.
"""

from dataclasses import dataclass, field
from functools import cached_property

import mujoco
import numpy as np

from models.contact import static_loads
from models.description import actuators_driving
from planner import Array
from sim.preparation.setup import Setup

PASSED = 2.0  # counts above the floor that a foot passes in a single command
FINE = 2.0  # counts, by which loads bend all legs that stand: each can follow its load
TRUSTED = 2.0  # counts, by which statics may be off before a rehearsal is trusted more


@dataclass(frozen=True, eq=False)
class LiftCounts:
    """Counts of all lift joints of a robot on servos with counts.

    With feed-forward, commands make up for the angles by which loads bend the servos.
    """

    setup: Setup
    feed_forward: bool
    _known: dict[bytes, Array] = field(default_factory=dict, repr=False)

    def at(self, lift: Array, lag: Array, rehearsed: Array | None = None) -> Array:
        """Whole counts (n, F) of lift joints from joint zero, legs in ascending order.

        Each group is to be raised by a lift (n, G), and each joint lags behind its
        motion by a lag (n, F) and is bent by its load as was `rehearsed`, (n, F) [rad].
        """
        robot, resolution = self.setup.robot, self.setup.servo.resolution
        down = lift < PASSED * resolution  # (n, G)
        sets, which = np.unique(down, axis=0, return_inverse=True)
        known = np.array([self._bent(groups) for groups in sets])
        bent = known.reshape(len(sets), lag.shape[1])[which.ravel()]  # also of none
        if rehearsed is not None:
            now = rehearsed / resolution
            bent = np.where(np.abs(now - bent) <= TRUSTED, bent, now)
        raised = (robot.raise_sign * lift[:, robot.group_of_leg] + lag) / resolution
        on_floor = np.round(self._standing + self.height + bent)
        in_air = np.round(self._standing + raised + bent)
        return np.where(down[:, robot.group_of_leg], on_floor, in_air)

    @cached_property
    def _standing(self) -> Array:
        """Angle of each lift joint as the robot stands, in counts."""
        robot = self.setup.robot
        angles = [robot.standing_angle(joint) for joint in robot.lift_joints]
        return np.array(angles) / self.setup.servo.resolution

    @cached_property
    def height(self) -> Array:
        """Part of a count to add to each lift joint while its leg stands, shape (F,).

        No standing leg on any stratum is then near the middle between two counts. Of
        the gaps between remainders that one is taken for which counts change least from
        stratum to stratum, then the widest.
        """
        raise_sign = self.setup.robot.raise_sign
        loads = raise_sign * (self._standing + self._loads)
        remainders = np.unique(loads[np.isfinite(loads)] % 1)
        gaps = np.diff(remainders, append=remainders[0] + 1)
        shifts = (1 - remainders - gaps / 2) % 1 - 0.5

        def cost(place: int) -> tuple[float, float]:
            counts = np.round(loads + shifts[place])
            changes = np.nanmax(counts, axis=0) - np.nanmin(counts, axis=0)
            return float(changes.sum()), -float(gaps[place])

        return raise_sign * shifts[min(range(len(gaps)), key=cost)]

    @property
    def fine(self) -> bool:
        """Whether counts are so fine that lift joints follow their loads."""
        return self.least_bent >= FINE

    @cached_property
    def least_bent(self) -> float:
        """Counts by which the least load bends a leg, while others are in the air."""
        alone = np.isnan(self._loads).any(axis=1)
        return float(np.nanmin(np.abs(self._loads[alone]), initial=np.inf))

    @cached_property
    def _loads(self) -> Array:
        """Counts by which loads bend standing legs, (strata, feet); else NaN."""
        robot = self.setup.robot
        strata = sorted(set(robot.card.gait))
        down = [np.array([g in stratum for g in robot.groups]) for stratum in strata]
        rows = [np.where(d[robot.group_of_leg], self._bent(d), np.nan) for d in down]
        return np.stack(rows)

    def _bent(self, down: Array) -> Array:
        """Counts by which loads bend each lift joint, while some groups stand, (F,)."""
        if not self.feed_forward:
            return np.zeros(len(self.setup.robot.legs))
        key, setup = down.tobytes(), self.setup
        if key not in self._known:
            torque = lift_torques(setup, down[setup.robot.group_of_leg])
            joints = actuators_driving(setup.model, setup.robot.lift_joints)
            stiffness = setup.model.actuator_gainprm[joints, 0]
            self._known[key] = torque / (stiffness * setup.servo.resolution)
        return self._known[key]


def lift_torques(setup: Setup, down: Array) -> Array:
    """Static torque (F,) [N m] of each lift servo, legs at their angles of the start.

    On three feet the loads are determined; on more, feet stand as on equal springs.
    `down`, shape (F,), says which feet stand.
    """
    robot, stance, model = setup.robot, setup.kinematics.standing, setup.model
    loads = np.zeros(len(robot.legs))
    feet, center = stance.feet[down], stance.center_of_mass
    loads[down] = static_loads(feet[None], center[None])[0] * robot.weight_in(model)
    rise = stance.gives[:, 2] * robot.raise_sign  # of each foot by its joint [m/rad]
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    joints = actuators_driving(model, robot.lift_joints)
    places = model.jnt_dofadr[model.actuator_trnid[joints, 0]]
    return data.qfrc_bias[places] - loads * rise  # the first holds legs in the air
