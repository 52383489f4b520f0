"""Counts of lift joints, such that standing feet keep their load.

On coarse servos a count lifts a foot as far as its load bends the servo. A standing leg
that went a count up and down while its load changes a little would let go of the floor.
So a lift joint has one count for as long as the same feet stand, and a foot that lifts
or lands passes the heights at which it may touch in a single command; the standing feet
change theirs in that very command, while the load goes over.

What loads bend is known from statics. Where between two counts it lies is a matter of
the height that the body stands at, which nothing depends on: the height is chosen such
that counts change least from one set of standing feet to another, since what changes
pushes the body aside.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from models.description import actuator_of
from planner import Array
from sim.drive.statics import lift_torques
from sim.preparation.setup import Setup

PASSED = 2.0  # counts above the floor that a foot passes in a single command


@dataclass(frozen=True, eq=False)
class LiftCounts:
    """Counts of all lift joints of a robot on servos with counts.

    Attributes:
        setup: The robot and its servos.
        leads: Whether commands lead by what the load bends.
    """

    setup: Setup
    leads: bool
    _known: dict[bytes, Array] = field(default_factory=dict, repr=False)

    def at(self, lift: Array, lag: Array) -> Array:
        """Whole counts of the lift joints, from joint zero, legs in ascending order.

        Args:
            lift: How far each group is to be raised, shape (n, G) [rad].
            lag: How far each joint would lag behind its motion, shape (n, F) [rad].

        Returns:
            Shape (n, F).
        """
        robot, resolution = self.setup.robot, self.setup.servo.resolution
        down = lift < PASSED * resolution  # (n, G)
        sets, which = np.unique(down, axis=0, return_inverse=True)
        bent = np.array([self._bent(groups) for groups in sets])[which.ravel()]
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

        The middle between two counts is put into a gap between the remainders of all
        standing legs: where counts change least from stratum to stratum, and of such
        gaps into the widest.
        """
        loads = self._loads  # (S, F)
        remainders = np.unique(loads[np.isfinite(loads)] % 1)
        gaps = np.diff(remainders, append=remainders[0] + 1)
        shifts = (1 - remainders - gaps / 2) % 1 - 0.5

        def cost(place: int) -> tuple[float, float]:
            counts = np.round(loads + shifts[place])
            changes = np.nanmax(counts, axis=0) - np.nanmin(counts, axis=0)
            return float(changes.sum()), -float(gaps[place])

        best = min(range(len(gaps)), key=cost)
        shift: Array = self.setup.robot.raise_sign * shifts[best]
        return shift

    @property
    def _loads(self) -> Array:
        """Raising counts of all legs on the strata of the gait, (S, F); NaN in the air.

        Every leg stands on one of them at least.
        """
        robot, rows = self.setup.robot, list[Array]()
        for stratum in sorted(set(robot.card.gait)):
            down = np.array([group in stratum for group in robot.groups])
            counts = robot.raise_sign * (self._standing + self._bent(down))
            rows.append(np.where(down[robot.group_of_leg], counts, np.nan))
        return np.stack(rows)

    def _bent(self, down: Array) -> Array:
        """Counts by which loads bend each lift joint, while some groups stand, (F,)."""
        if not self.leads:
            return np.zeros(len(self.setup.robot.legs))
        key = down.tobytes()
        if key not in self._known:
            self._known[key] = self._bent_by_loads(down)
        return self._known[key]

    def _bent_by_loads(self, down: Array) -> Array:
        setup = self.setup
        torque = lift_torques(setup, down[setup.robot.group_of_leg])
        joints = [actuator_of(setup.model, j) for j in setup.robot.lift_joints]
        stiffness = setup.model.actuator_gainprm[joints, 0]
        bent: Array = torque / (stiffness * setup.servo.resolution)
        return bent
